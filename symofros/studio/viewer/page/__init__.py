"""The page in the browser: viser's server and scene, the controls, and the state that they show."""
