//! Which of several places that would overlap are taken.

use super::Place;

/// The places that are taken so far, and those that may still overlap with one that comes.
#[derive(Debug)]
pub struct Chosen {
    by_value: bool,
    taken: Vec<Place>,
    /// Places that overlap, directly or through others.
    open: Vec<Place>,
    open_end: f64,
}

impl Chosen {
    pub fn new(by_value: bool) -> Self {
        Self { by_value, taken: Vec::new(), open: Vec::new(), open_end: f64::NEG_INFINITY }
    }

    /// Whether a place is taken as soon as it is found.
    pub fn takes_first(&self) -> bool {
        !self.by_value
    }

    /// Places come in the order of their starts.
    pub fn add(&mut self, place: Place) {
        if !self.by_value {
            self.taken.push(place);
            return;
        }
        if place.start >= self.open_end {
            self.close();
        }
        self.open_end = self.open_end.max(place.end);
        self.open.push(place);
    }

    pub fn finish(mut self) -> Vec<Place> {
        self.close();
        self.taken
    }

    /// Takes the place with the highest value, then the highest of those that do not overlap with
    /// it, and so on; of equal values the first.
    fn close(&mut self) {
        let mut open = std::mem::take(&mut self.open);
        open.sort_by(|a, b| b.value.total_cmp(&a.value).then(a.start.total_cmp(&b.start)));
        let mut taken: Vec<Place> = Vec::new();
        for place in open {
            if taken.iter().all(|other| place.end <= other.start || place.start >= other.end) {
                taken.push(place);
            }
        }
        taken.sort_by(|a, b| a.start.total_cmp(&b.start));
        self.taken.append(&mut taken);
        self.open_end = f64::NEG_INFINITY;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(by_value: bool, places: &[(f64, f64, f64)]) -> Vec<(f64, f64)> {
        let mut chosen = Chosen::new(by_value);
        for &(start, end, value) in places {
            chosen.add(Place { start, end, zone: None, columns: Vec::new(), value });
        }
        chosen.finish().iter().map(|place| (place.start, place.end)).collect()
    }

    #[test]
    fn of_places_that_overlap_the_highest_is_taken() {
        let places = [
            (0.0, 10.0, 1.0),
            (5.0, 15.0, 3.0),
            (14.0, 24.0, 2.0),
            (15.0, 25.0, 2.0),
            (30.0, 40.0, 0.0),
        ];
        assert_eq!(taken(true, &places), [(5.0, 15.0), (15.0, 25.0), (30.0, 40.0)]);
    }

    #[test]
    fn of_equal_values_the_first_is_taken() {
        assert_eq!(
            taken(true, &[(0.0, 10.0, 1.0), (1.0, 11.0, 1.0), (10.0, 20.0, 1.0)]),
            [(0.0, 10.0), (10.0, 20.0)]
        );
        assert_eq!(
            taken(false, &[(0.0, 10.0, 1.0), (10.0, 20.0, 5.0)]),
            [(0.0, 10.0), (10.0, 20.0)]
        );
    }
}
