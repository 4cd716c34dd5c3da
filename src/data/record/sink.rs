//! Where the numbers of a text go.

/// Destination of the numbers of a column.
pub(super) struct Sink {
    pub name: String,
    /// Index of the cell in a row.
    pub position: usize,
    pub factor: f64,
    pub values: Vec<f64>,
}
