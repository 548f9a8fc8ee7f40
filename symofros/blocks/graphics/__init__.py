"""Graphics (section 6.2 of the paper): what is kept, plotted and viewed of a run."""
