"""What readers of foreign formats share: options, a neutral tree of bodies, and the system that is made of it."""
