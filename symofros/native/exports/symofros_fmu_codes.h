/* symofros_fmu_codes.h - what all units have in common: phases of a unit, and what is wrong with a call. Written by hand. */

typedef enum { FMU_INSTANTIATED, FMU_INITIALISING, FMU_EVENT, FMU_CONTINUOUS, FMU_STEPPING, FMU_TERMINATED } fmu_phase;

enum {
    FMU_OK, FMU_NOT_ALLOWED, FMU_UNKNOWN, FMU_SINGULAR, FMU_WRONG_MODE, FMU_START_NOT_CONSISTENT,
    FMU_STOP_BEFORE_START, FMU_NO_MEMORY, FMU_OTHER_MODEL, FMU_BUFFER_TOO_SMALL,
    FMU_BEYOND_THEORY, FMU_NO_ROTATION, FMU_INPUT_NO_ROTATION, FMU_NULL, FMU_WRONG_SIZE,
    FMU_NOT_DIFFERENTIATED, FMU_STEP_REFUSED, /* said in f->message */
    FMU_PARAMETERS /* and beyond: by the number of the condition that the parameters do not meet */
};

