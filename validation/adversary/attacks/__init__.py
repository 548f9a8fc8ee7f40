"""What is attacked: a strategy of scenes, our answer, an independent route, a bound, one module each."""
