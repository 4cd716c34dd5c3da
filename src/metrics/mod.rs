//! Numbers from signals: slices in, numbers out, no I/O.
