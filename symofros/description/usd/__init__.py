"""USD in: rigid bodies, joints and masses of UsdPhysics; usd_worker reads the stage, the others make a System of it."""
