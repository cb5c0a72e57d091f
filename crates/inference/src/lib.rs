//! Model against measurement: fits with intervals and warnings, and the ladder of errors.
