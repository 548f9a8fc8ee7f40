"""What the site needs beyond Sphinx: figures of the reports, the command line's help, links out of docs/."""
