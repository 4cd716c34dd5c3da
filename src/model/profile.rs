//! Contact geometry of wheel and rail over the lateral displacement of the wheelset.

use super::parameters::Vehicle;

/// A table over the lateral displacement, strictly increasing. Lengths in mm, angles in rad; sides
/// right, left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileTable {
    /// Displacement of the wheelset relative to the track, positive to the right.
    pub displacement: Vec<f64>,
    pub radius_deviation: [Vec<f64>; 2],
    pub contact_angle: [Vec<f64>; 2],
}

/// Radius deviation in m and contact angle in rad of one wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Geometry {
    pub rho: f64,
    pub gamma: f64,
}

/// The profile of one vehicle: blended, scaled, in SI units.
#[derive(Clone, Debug)]
pub struct Profile {
    displacement: Vec<f64>,
    /// 1 / (distance of the points), if constant.
    density: Option<f64>,
    table: [Vec<Geometry>; 2],
}

impl Profile {
    /// The profile with the vehicle's wear and conicity; `None` if it is worn and there is no worn
    /// table, or if the two tables have different displacements.
    pub fn new(new: &ProfileTable, worn: Option<&ProfileTable>, vehicle: &Vehicle) -> Option<Self> {
        let share = vehicle.worn_share;
        let worn = if share == 0.0 { new } else { worn? };
        if worn.displacement != new.displacement {
            return None;
        }
        let blend = |a: f64, b: f64| (1.0 - share) * a + share * b;
        let side = |j: usize| {
            let at = |i: usize| Geometry {
                rho: blend(new.radius_deviation[j][i], worn.radius_deviation[j][i])
                    * 1e-3
                    * vehicle.conicity_scale,
                gamma: blend(new.contact_angle[j][i], worn.contact_angle[j][i]),
            };
            (0..new.displacement.len()).map(at).collect::<Vec<_>>()
        };
        let displacement: Vec<f64> = new.displacement.iter().map(|mm| mm * 1e-3).collect();
        let points = displacement.len();
        let width = (displacement[points - 1] - displacement[0]) / (points - 1) as f64;
        let even =
            displacement.windows(2).all(|pair| (pair[1] - pair[0] - width).abs() < 1e-9 * width);
        Some(Self { density: even.then_some(1.0 / width), table: [side(0), side(1)], displacement })
    }

    /// Range of displacements of the table, in m.
    pub fn range(&self) -> (f64, f64) {
        (self.displacement[0], self.displacement[self.displacement.len() - 1])
    }

    /// Interpolates linearly; constant beyond the ends. `side`: 0 right, 1 left; `delta` in m.
    #[inline(always)]
    pub fn at(&self, side: usize, delta: f64) -> Geometry {
        let last = self.displacement.len() - 2;
        let (i, share) = match self.density {
            Some(density) => {
                let place = (delta - self.displacement[0]) * density;
                let i = (place as usize).min(last);
                (i, place - i as f64)
            }
            None => {
                let i = self.displacement.partition_point(|d| *d <= delta).clamp(1, last + 1) - 1;
                (
                    i,
                    (delta - self.displacement[i])
                        / (self.displacement[i + 1] - self.displacement[i]),
                )
            }
        };
        let share = share.clamp(0.0, 1.0);
        let (from, to) = (self.table[side][i], self.table[side][i + 1]);
        Geometry {
            rho: from.rho + share * (to.rho - from.rho),
            gamma: from.gamma + share * (to.gamma - from.gamma),
        }
    }
}
