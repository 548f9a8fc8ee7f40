"""Contact: steps in a stiff impact, friction that holds, bounces that accumulate, motions beside those of engines."""
