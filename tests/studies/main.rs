//! Studies of selections, and protocols side by side.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod pools;
    pub mod program;
    pub mod tools;
}

mod compare;
mod exercise;
mod impact;
mod margin;
mod study;
mod study_command;
mod study_flips;
mod study_large;
