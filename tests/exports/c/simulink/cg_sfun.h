/* What stands at the end of an S-function; here the engine's part. */
#include <math.h>
#include <stdio.h>

#ifdef SYM_BLOCK_PROGRAM
#include "sampled.h"
#else
#include "continuous.h"
#endif
