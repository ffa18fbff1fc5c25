#include "prior/rest_state.h"
