"""Long campaigns over dask.distributed: cross-checks of many states, sweeps over parameters; docs/campaigns.md."""
