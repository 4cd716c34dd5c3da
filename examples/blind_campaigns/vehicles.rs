//! Four vehicles: a coach, a lighter and shorter railcar, a loaded wagon, a heavy locomotive.

use std::path::Path;

use fishplate::model::Vehicle;

/// A vehicle, defined by its differences from the coach of the examples.
pub struct Design {
    pub name: &'static str,
    pub category: &'static str,
    pub secondary_suspension: bool,
    /// Range of its speeds in km/h, and its largest cant deficiency in mm.
    pub speeds: (f64, f64),
    pub deficiency: f64,
    pub differs: &'static [(&'static str, f64)],
}

pub const COACH: Design = Design {
    name: "Coach",
    category: "passenger",
    secondary_suspension: true,
    speeds: (60.0, 160.0),
    deficiency: 105.0,
    differs: &[],
};

pub const RAILCAR: Design = Design {
    name: "Railcar",
    category: "passenger",
    secondary_suspension: true,
    speeds: (60.0, 140.0),
    deficiency: 110.0,
    differs: &[
        ("geometry.half_bogie_spacing", 8.6),
        ("geometry.half_wheelbase", 1.15),
        ("car_body.mass", 27_000.0),
        ("car_body.inertia_roll", 45_000.0),
        ("car_body.inertia_pitch", 1.35e6),
        ("car_body.inertia_yaw", 1.35e6),
        ("car_body.cog_height", 1.65),
        ("bogie.mass", 3100.0),
        ("bogie.inertia_yaw", 3500.0),
        ("wheelset.mass", 1600.0),
        ("wheelset.radius", 0.42),
        ("primary.kx", 9.0e6),
        ("primary.kz", 1.05e6),
        ("secondary.ky", 2.0e5),
        ("secondary.kz", 3.6e5),
        ("secondary.cy", 3.0e4),
        ("secondary.cz", 1.8e4),
    ],
};

pub const WAGON: Design = Design {
    name: "Wagon",
    category: "freight",
    secondary_suspension: false,
    speeds: (50.0, 100.0),
    deficiency: 65.0,
    differs: &[
        ("geometry.half_bogie_spacing", 5.2),
        ("geometry.half_wheelbase", 0.9),
        ("car_body.mass", 74_000.0),
        ("car_body.inertia_roll", 118_000.0),
        ("car_body.inertia_pitch", 9.4e5),
        ("car_body.inertia_yaw", 9.4e5),
        ("car_body.cog_height", 1.95),
        ("car_body.floor_height", 1.2),
        ("bogie.mass", 2000.0),
        ("bogie.inertia_roll", 1500.0),
        ("bogie.inertia_pitch", 1300.0),
        ("bogie.inertia_yaw", 2500.0),
        ("wheelset.mass", 1400.0),
        ("wheelset.inertia_roll", 850.0),
        ("wheelset.inertia_yaw", 850.0),
        ("wheelset.inertia_spin", 100.0),
        ("primary.kx", 8.5e6),
        ("primary.kz", 1.45e6),
        ("primary.cx", 1.5e4),
        ("primary.cz", 3.0e3),
        ("primary.friction_z", 4.5e3),
        ("primary.friction_y", 2.2e3),
        ("primary.friction_displacement", 1.5e-3),
        ("secondary.kx", 0.0),
        ("secondary.ky", 1.2e7),
        ("secondary.kz", 1.5e7),
        ("secondary.cz", 1.0e5),
        ("secondary.cy", 1.5e5),
        ("secondary.half_spacing", 0.85),
        ("secondary.anti_roll_stiffness", 0.0),
        ("secondary.yaw_damper_series_stiffness", 0.0),
        ("secondary.yaw_damper_damping", 0.0),
        ("secondary.bumpstop_gap", 0.1),
        ("secondary.centre_friction_torque", 1.5e4),
        ("secondary.centre_friction_angle", 2.0e-3),
        ("contact.vertical_stiffness", 7.0e7),
        ("contact.vertical_damping", 1.2e5),
    ],
};

/// Four axles of 20 t, 98 kN a wheel.
pub const LOCOMOTIVE: Design = Design {
    name: "Locomotive",
    category: "locomotive",
    secondary_suspension: true,
    speeds: (60.0, 140.0),
    deficiency: 100.0,
    differs: &[
        ("geometry.half_bogie_spacing", 5.0),
        ("geometry.half_wheelbase", 1.4),
        ("car_body.mass", 48_000.0),
        ("car_body.inertia_roll", 8.0e4),
        ("car_body.inertia_pitch", 1.1e6),
        ("car_body.inertia_yaw", 1.1e6),
        ("car_body.cog_height", 1.9),
        ("car_body.floor_height", 1.5),
        ("bogie.mass", 10_000.0),
        ("bogie.inertia_roll", 6000.0),
        ("bogie.inertia_pitch", 1.2e4),
        ("bogie.inertia_yaw", 1.6e4),
        ("wheelset.mass", 3000.0),
        ("wheelset.inertia_roll", 1900.0),
        ("wheelset.inertia_yaw", 1900.0),
        ("wheelset.inertia_spin", 400.0),
        ("wheelset.radius", 0.6),
        ("primary.kx", 2.0e7),
        ("primary.ky", 6.0e6),
        ("primary.kz", 1.6e6),
        ("primary.cz", 2.5e4),
        ("primary.half_spacing", 1.05),
        ("secondary.kx", 4.0e5),
        ("secondary.ky", 4.0e5),
        ("secondary.kz", 1.2e6),
        ("secondary.cz", 6.0e4),
        ("secondary.cy", 6.0e4),
        ("secondary.anti_roll_stiffness", 5.0e5),
        ("secondary.yaw_damper_damping", 4.0e5),
        ("contact.vertical_stiffness", 8.0e7),
        ("contact.vertical_damping", 1.5e5),
    ],
};

impl Design {
    /// The vehicle of the simulation.
    ///
    /// # Errors
    /// The example cannot be read.
    pub fn vehicle(&self) -> Result<Vehicle, String> {
        let mut vehicle = nominal()?;
        self.differs
            .iter()
            .try_for_each(|(key, value)| vehicle.set(key, *value))
            .map_err(|_| "a value is not admissible")?;
        Ok(vehicle)
    }
}

/// Folder of the campaign with the vehicle and profile of the designs.
pub fn example() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/coach-good"))
}

fn nominal() -> Result<Vehicle, String> {
    let path = example().join("vehicle.yaml");
    let text =
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let source = fishplate::source::Source::new("vehicle.yaml", text);
    let tree = fishplate::yaml::load(&source, &mut fishplate::problem::Problems::default())
        .ok_or("vehicle.yaml is no YAML")?;
    let number =
        |key: &str| tree.lookup(key).and_then(|node| fishplate::simulate::number_of(node, key));
    Vehicle::from_values(number).map_err(|_| "vehicle.yaml lacks something".to_string())
}
