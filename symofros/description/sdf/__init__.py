"""SDFormat in: links with poses in frames that refer to each other become a tree of bodies."""
