//! The program as a whole: command line, memory, files, stores.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod program;
}

mod budgets;
mod cli;
mod disk;
mod memory;
mod store;
