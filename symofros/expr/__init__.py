"""The language of values: a hash-consed graph of scalar operations. Knows no mechanics."""
