//! The reference vehicle model (`docs/model.md`) against motions, balances and records that are
//! known from elsewhere. Each test says where its numbers come from and how close is close.

#![allow(
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

mod balance;
mod check_values;
mod code_to_code;
mod common;
mod contact;
mod exact_motions;
mod failures;
mod friction;
mod integrator;
mod modes;
mod stability;
mod symmetry;
