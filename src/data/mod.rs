//! Reads and writes campaigns. Nothing read is trusted before it is checked, and no channel, quantity or column is known here:
//! what is needed is asked for by the caller.

pub mod tree;
