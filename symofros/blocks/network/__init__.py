"""Network (section 6.2 of the paper): signals to and from other programs, by UDP and by Zenoh."""
