//! Protocols from their text to the graph, what they need, and the drafts of new ones.

#[path = "../common"]
mod common {
    pub mod campaign;
    pub mod program;
    pub mod straight;
    #[expect(dead_code, reason = "the contents of elements are for the tests of figures")]
    pub mod xml;
}

mod check;
mod clauses;
mod generality;
mod graph;
mod init;
mod needs;
mod robust;
mod syntax;
mod templates;
mod trials;
mod units;
