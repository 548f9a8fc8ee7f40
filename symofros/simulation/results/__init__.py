"""What a run leaves: outcome, trajectories, files, plots."""
