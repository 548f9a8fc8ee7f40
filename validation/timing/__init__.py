"""How fast the generated C is against other engines' C and C++, what it costs to make, and how both grow."""
