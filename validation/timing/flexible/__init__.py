"""The planar flexible robot against Exudyn at equal accuracy."""
