//! The signals of a record.

/// The signals of a record. Values are in the unit of their channel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signals {
    /// Position on the axis, in m for a record over distance.
    pub axis: Vec<f64>,
    /// Whether the axis is the time itself, in s.
    pub over_time: bool,
    /// Samples per second.
    pub rate: f64,
    pub channels: Vec<Channel>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    pub name: String,
    pub values: Vec<f64>,
}

impl Signals {
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// The number of a channel.
    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|channel| channel.name == name)
    }
}
