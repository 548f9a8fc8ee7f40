"""One page over all reports: the verdict of each, its telling figures, where its numbers come from."""
