/* symofros_fmu_codes.h - what all units have in common: phases of a unit, and what is wrong with a call. Written by hand. */

typedef enum { FMU_INSTANTIATED, FMU_INITIALISING, FMU_EVENT, FMU_CONTINUOUS, FMU_STEPPING, FMU_TERMINATED } fmu_phase;

enum {
    FMU_OK, FMU_NOT_ALLOWED, FMU_UNKNOWN, FMU_SINGULAR, FMU_WRONG_MODE, FMU_START_NOT_CONSISTENT,
    FMU_STOP_BEFORE_START, FMU_NO_MEMORY, FMU_OTHER_MODEL, FMU_BUFFER_TOO_SMALL,
    FMU_BEYOND_THEORY, FMU_NO_ROTATION, FMU_INPUT_NO_ROTATION, FMU_NULL, FMU_WRONG_SIZE,
    FMU_NOT_DIFFERENTIATED, FMU_REFUSED, /* said in f->message */
    FMU_PARAMETERS /* and beyond: by the number of the condition that the parameters do not meet */
};

/* Why a motion ended there, which f->message says; NULL: said by a code. */
static const char *fmu_reason(int32_t status) {
    switch (status) {
    case SYM_ENGAGED_APART: return "constraints engage while they are apart";
    case SYM_ACTION_REFUSED: return "what an event sets is refused";
    case SYM_ACTS_WITHOUT_END: return "an event acts again and again at the same instant, or leaves bodies at rest on each other";
    case SYM_MODES_UNDECIDED: return "no modes of friction that sticks agree with the motion that they bring about";
    case SYM_HELD_TWICE: return "friction holds joints that others or constraints hold already";
    case SYM_WRONG_CONTACT:
        return "a contact that rests is penetrated, holds by a force that draws, or is one of seventeen rigid ones that touch at once";
    case SYM_NO_CONTACT_FORCE:
        return "no forces of rigid contacts were found that agree with Coulomb's law (Painleve's paradox)";
    case SYM_CONTACTS_AMBIGUOUS:
        return "several motions agree with Coulomb's law at rigid contacts (Painleve's paradox)";
    case SYM_FLAT_RIM: return "a rim of a rigid contact lies on its plane, a segment along its surface, and nothing else carries it; or a rim touches a cylinder at two points";
    default: return NULL;
    }
}
