/* Internal to the receiver: reads the frames of a complete set into rx->estimate. Not to be included by firmware. */
#ifndef PELORUS_CAN_FIELDS_H
#define PELORUS_CAN_FIELDS_H

#include "pelorus_can.h"

/* `step_usable`: the estimate before was received, so that the way since then means something. */
void pelorus_can_read_estimate(pelorus_can_receiver* rx, bool step_usable);

#endif
