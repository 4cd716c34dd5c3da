//! The parameters of the vehicle model: one table of key, unit, admissible values, neutral value
//! and meaning.

/// Admissible values of a parameter. The plausible range is narrower and is given by catalogues of
/// effects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admissible {
    Any,
    Positive,
    NotNegative,
    /// 0 to 1.
    Share,
    /// A whole number from 1 to 4, wheelsets counted from the front.
    Wheelset,
    /// -1 left, 0 both, 1 right.
    Side,
}

impl Admissible {
    /// Whether a finite number is admissible.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Share => (0.0..=1.0).contains(&value),
                Self::Wheelset => [1.0, 2.0, 3.0, 4.0].contains(&value),
                Self::Side => [-1.0, 0.0, 1.0].contains(&value),
            }
    }

    pub fn in_words(self) -> &'static str {
        match self {
            Self::Any => "a number",
            Self::Positive => "a number above 0",
            Self::NotNegative => "0 or more",
            Self::Share => "0 to 1",
            Self::Wheelset => "1, 2, 3 or 4",
            Self::Side => "`both`, `R` or `L`",
        }
    }
}

/// A parameter of the vehicle file.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// As in the vehicle file, nested keys joined by dots.
    pub key: &'static str,
    pub unit: &'static str,
    pub admissible: Admissible,
    /// Default value; a vehicle file must give the parameters without one.
    pub neutral: Option<f64>,
    pub meaning: &'static str,
    field: fn(&mut Vehicle) -> &mut f64,
}

macro_rules! parameters {
    ($($field:ident $key:literal [$unit:literal] $admissible:ident $(= $neutral:literal)?, $meaning:literal;)*) => {
        /// A vehicle: all parameters of the model, in SI units unless its entry in [`PARAMETERS`]
        /// states otherwise.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct Vehicle {
            $(#[doc = $meaning] pub $field: f64,)*
        }

        /// All parameters in the order of the vehicle file.
        pub const PARAMETERS: &[Parameter] = &[$(Parameter {
            key: $key,
            unit: $unit,
            admissible: Admissible::$admissible,
            neutral: parameters!(@neutral $($neutral)?),
            meaning: $meaning,
            field: |vehicle| &mut vehicle.$field,
        },)*];
    };
    (@neutral $neutral:literal) => { Some($neutral) };
    (@neutral) => { None };
}

parameters! {
    friction "friction" ["-"] Positive, "friction coefficient between wheel and rail";
    half_bogie_spacing "geometry.half_bogie_spacing" ["m"] Positive, "car body centre to bogie centre";
    half_wheelbase "geometry.half_wheelbase" ["m"] Positive, "bogie centre to wheelset";
    car_mass "car_body.mass" ["kg"] Positive, "mass of the car body";
    car_inertia_roll "car_body.inertia_roll" ["kg m^2"] Positive, "roll inertia of the car body";
    car_inertia_pitch "car_body.inertia_pitch" ["kg m^2"] Positive, "pitch inertia of the car body";
    car_inertia_yaw "car_body.inertia_yaw" ["kg m^2"] Positive, "yaw inertia of the car body";
    car_cog_height "car_body.cog_height" ["m"] Positive, "centre of gravity of the car body above the rail";
    floor_height "car_body.floor_height" ["m"] Positive, "accelerometers above the rail";
    bogie_mass "bogie.mass" ["kg"] Positive, "mass of a bogie frame";
    bogie_inertia_roll "bogie.inertia_roll" ["kg m^2"] Positive, "roll inertia of a bogie frame";
    bogie_inertia_pitch "bogie.inertia_pitch" ["kg m^2"] Positive, "pitch inertia of a bogie frame";
    bogie_inertia_yaw "bogie.inertia_yaw" ["kg m^2"] Positive, "yaw inertia of a bogie frame";
    bogie_cog_height "bogie.cog_height" ["m"] Positive, "centre of gravity of a bogie frame above the rail";
    wheelset_mass "wheelset.mass" ["kg"] Positive, "mass of a wheelset";
    wheelset_inertia_roll "wheelset.inertia_roll" ["kg m^2"] Positive, "roll inertia of a wheelset";
    wheelset_inertia_yaw "wheelset.inertia_yaw" ["kg m^2"] Positive, "yaw inertia of a wheelset";
    wheelset_inertia_spin "wheelset.inertia_spin" ["kg m^2"] Positive, "inertia of a wheelset about its axle";
    wheel_radius "wheelset.radius" ["m"] Positive, "nominal rolling radius";
    primary_kx "primary.kx" ["N/m"] NotNegative, "longitudinal stiffness per axle box";
    primary_ky "primary.ky" ["N/m"] NotNegative, "lateral stiffness per axle box";
    primary_kz "primary.kz" ["N/m"] Positive, "vertical stiffness per axle box";
    primary_cx "primary.cx" ["N s/m"] NotNegative, "longitudinal damping per axle box";
    primary_cy "primary.cy" ["N s/m"] NotNegative, "lateral damping per axle box";
    primary_cz "primary.cz" ["N s/m"] NotNegative, "vertical damping per axle box";
    primary_half_spacing "primary.half_spacing" ["m"] Positive, "track centre to axle box";
    primary_kx_scale "primary.kx_scale" ["-"] NotNegative = 1.0, "factor of the longitudinal primary stiffness";
    primary_friction_z "primary.friction_z" ["N"] NotNegative = 0.0, "dry friction per axle box, vertical";
    primary_friction_y "primary.friction_y" ["N"] NotNegative = 0.0, "dry friction per axle box, lateral";
    primary_friction_displacement "primary.friction_displacement" ["m"] Positive = 1.0e-3, "elastic displacement before the dry friction slides";
    secondary_kx "secondary.kx" ["N/m"] NotNegative, "longitudinal stiffness per side";
    secondary_ky "secondary.ky" ["N/m"] NotNegative, "lateral stiffness per side";
    secondary_kz "secondary.kz" ["N/m"] Positive, "vertical stiffness per side";
    secondary_cz "secondary.cz" ["N s/m"] NotNegative, "vertical damping per side";
    secondary_cz_scale "secondary.cz_scale" ["-"] NotNegative = 1.0, "factor of the vertical secondary damping";
    secondary_cy "secondary.cy" ["N s/m"] NotNegative, "lateral damping per bogie";
    secondary_cy_scale "secondary.cy_scale" ["-"] NotNegative = 1.0, "factor of the lateral secondary damping";
    secondary_hysteresis "secondary.hysteresis" ["-"] NotNegative = 0.0, "lateral secondary stiffness in fast motion, less that at rest, as a share of that at rest";
    secondary_hysteresis_time "secondary.hysteresis_time" ["s"] Positive = 0.15, "relaxation time of the additional lateral stiffness";
    secondary_half_spacing "secondary.half_spacing" ["m"] Positive, "track centre to secondary spring";
    secondary_height "secondary.height" ["m"] Positive, "secondary springs above the rail";
    anti_roll_stiffness "secondary.anti_roll_stiffness" ["N m/rad"] NotNegative = 0.0, "anti-roll bar per bogie";
    anti_roll_scale "secondary.anti_roll_scale" ["-"] NotNegative = 1.0, "factor of the anti-roll stiffness";
    yaw_damper_stiffness "secondary.yaw_damper_series_stiffness" ["N/m"] NotNegative = 0.0, "series stiffness of a yaw damper, one per side";
    yaw_damper_damping "secondary.yaw_damper_damping" ["N s/m"] NotNegative = 0.0, "damping of a yaw damper";
    yaw_damper_half_spacing "secondary.yaw_damper_half_spacing" ["m"] NotNegative = 0.0, "track centre to yaw damper";
    yaw_damper_remaining "secondary.yaw_damper_remaining" ["-"] Share = 1.0, "remaining share of the yaw dampers";
    bumpstop_gap "secondary.bumpstop_gap" ["m"] NotNegative, "lateral play to either side before the bump stop";
    bumpstop_stiffness "secondary.bumpstop_stiffness" ["N/m"] NotNegative, "bump stop per bogie";
    centre_friction_torque "secondary.centre_friction_torque" ["N m"] NotNegative = 0.0, "friction torque against bogie rotation, per bogie";
    centre_friction_angle "secondary.centre_friction_angle" ["rad"] Positive = 3.0e-3, "elastic rotation at full friction torque";
    half_contact_spacing "contact.half_contact_spacing" ["m"] Positive, "track centre to rolling circle";
    kalker_scale "contact.kalker_scale" ["-"] Positive, "factor of the Kalker coefficients";
    shear_modulus "contact.shear_modulus" ["N/m^2"] Positive, "shear modulus of wheel and rail";
    kalker_c11 "contact.C11" ["-"] Positive, "Kalker coefficient, longitudinal";
    kalker_c22 "contact.C22" ["-"] Positive, "Kalker coefficient, lateral";
    kalker_c23 "contact.C23" ["-"] NotNegative, "Kalker coefficient, lateral by spin";
    ellipse_ab "contact.ellipse_ab" ["m^2"] Positive, "product of the semi-axes of the contact ellipse at the reference load";
    ellipse_reference_load "contact.ellipse_reference_load" ["N"] Positive, "normal force at which the contact ellipse is given";
    contact_kc "contact.vertical_stiffness" ["N/m"] Positive, "contact and track in series, per wheel";
    contact_cc "contact.vertical_damping" ["N s/m"] NotNegative, "damping of contact and track, per wheel";
    stop_displacement "contact.stop_displacement" ["m"] Positive, "lateral displacement of the wheel where the flange stop begins";
    stop_stiffness "contact.stop_stiffness" ["N/m"] NotNegative, "stiffness of the flange stop";
    polach_adhesion "contact.polach_adhesion" ["-"] NotNegative = 0.0, "creep law of Polach: reduction in the area of adhesion; 0: the law of Shen, Hedrick and Elkins";
    polach_slip "contact.polach_slip" ["-"] NotNegative = 0.4, "creep law of Polach: reduction in the area of slip";
    chartet_exponent "contact.chartet_exponent" ["-"] NotNegative = 0.0, "creep law of Chartet: its exponent, about 2; 0: another law";
    worn_share "profile.worn_share" ["-"] Share = 0.0, "0: the given profile; 1: the worn profile; blended in between";
    conicity_scale "profile.conicity_scale" ["-"] NotNegative = 1.0, "factor of the radius deviations";
    payload_mass "payload.mass" ["kg"] NotNegative = 0.0, "payload in the car body";
    payload_offset "payload.lateral_offset" ["m"] Any = 0.0, "centre of gravity of the car body to the right of the centre line";
    crosswind_force "crosswind.force" ["N"] Any = 0.0, "wind force on the car body, positive to the right";
    crosswind_height "crosswind.height" ["m"] NotNegative = 2.2, "wind force above the rail";
    bending_frequency "body_bending.frequency" ["Hz"] NotNegative = 0.0, "first vertical bending of the car body; 0: rigid";
    bending_mass "body_bending.modal_mass" ["kg"] Positive = 8000.0, "modal mass of the bending mode";
    bending_damping "body_bending.damping_ratio" ["-"] NotNegative = 0.02, "damping ratio of the bending mode";
    bending_shape "body_bending.shape_at_bogies" ["-"] Any = 0.45, "bending mode above the bogies";
    roundness_wheelset "out_of_roundness.wheelset" ["-"] Wheelset = 1.0, "wheelset that is out of round";
    roundness_side "out_of_roundness.side" ["-"] Side = 0.0, "wheel that is out of round";
    roundness_amplitude "out_of_roundness.amplitude" ["m"] NotNegative = 0.0, "amplitude of the radius deviation";
    roundness_harmonic "out_of_roundness.harmonic" ["-"] NotNegative = 1.0, "waves per revolution";
    irregularity_scale "track.irregularity_scale" ["-"] NotNegative = 1.0, "factor of all track irregularities";
    residual_irregularity "track.residual_irregularity" ["mm"] NotNegative = 0.0, "short waves not measured by the recording car: standard deviation added to each irregularity";
    curvature_scale "track.curvature_scale" ["-"] Positive = 1.0, "factor of the curvature";
    gauge_error "track.gauge_error" ["mm"] Any = 0.0, "gauge widening added everywhere";
    cant_error "track.cant_error" ["mm"] Any = 0.0, "cant added in curves, at full curvature";
}

/// Why values do not give a vehicle.
#[derive(Clone, Copy, Debug)]
pub enum VehicleFault {
    /// No value for a parameter without a default.
    Missing(&'static Parameter),
    Inadmissible(&'static Parameter, f64),
}

impl Vehicle {
    /// A vehicle from named values; defaults where `value` gives none.
    ///
    /// # Errors
    /// Every parameter that is missing or not admissible.
    pub fn from_values(value: impl Fn(&str) -> Option<f64>) -> Result<Self, Vec<VehicleFault>> {
        let mut vehicle = Self::default();
        let mut faults = Vec::new();
        for parameter in PARAMETERS {
            match value(parameter.key).or(parameter.neutral) {
                None => faults.push(VehicleFault::Missing(parameter)),
                Some(value) if !parameter.admissible.holds(value) => {
                    faults.push(VehicleFault::Inadmissible(parameter, value))
                }
                Some(value) => *(parameter.field)(&mut vehicle) = value,
            }
        }
        if faults.is_empty() { Ok(vehicle) } else { Err(faults) }
    }

    /// Sets one parameter by its key.
    ///
    /// # Errors
    /// The value is not admissible, or there is no such parameter (`None`).
    pub fn set(&mut self, key: &str, value: f64) -> Result<(), Option<VehicleFault>> {
        let parameter = parameter(key).ok_or(None)?;
        if !parameter.admissible.holds(value) {
            return Err(Some(VehicleFault::Inadmissible(parameter, value)));
        }
        *(parameter.field)(self) = value;
        Ok(())
    }

    /// The value of a parameter by its key.
    pub fn get(&self, key: &str) -> Option<f64> {
        parameter(key).map(|parameter| *(parameter.field)(&mut self.clone()))
    }

    /// Static vertical wheel force of the tare vehicle in N.
    pub fn static_wheel_load(&self) -> f64 {
        (self.car_mass + 2.0 * self.bogie_mass + 4.0 * self.wheelset_mass) * super::G / 8.0
    }
}

/// The parameter with this key.
pub fn parameter(key: &str) -> Option<&'static Parameter> {
    PARAMETERS.iter().find(|parameter| parameter.key == key)
}
