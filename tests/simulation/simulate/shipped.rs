//! The shipped catalogue against the list of effects that the model was asked for: names, units,
//! ranges.

use fishplate::effects::{Acts, Catalogue, Effect, Parameter};
use fishplate::library::{self, CATALOGUES};
use fishplate::model::PARAMETERS;
use fishplate::problem::Problems;
use fishplate::simulate::model_parameters;
use fishplate::units::Unit;

use super::{Place, SECTIONS};

fn catalogue() -> Catalogue {
    let mut problems = Problems::default();
    let source = library::find_catalogue(CATALOGUES[0].name, None).expect("shipped");
    let read = fishplate::effects::read(
        &source,
        &library::parent_catalogue,
        &model_parameters(),
        &mut problems,
    );
    assert!(problems.0.is_empty(), "{}", problems.render(false));
    read.expect("a catalogue")
}

/// Effect, parameter, unit, and values that must be possible: section 9 of the model's
/// specification.
const ASKED: [(&str, &str, &str, &[f64]); 33] = [
    ("friction", "friction", "-", &[0.10, 0.65]),
    ("worn_profile", "profile.worn_share", "-", &[0.0, 1.0]),
    ("worn_profile", "profile.conicity_scale", "-", &[0.5, 3.0]),
    ("body_bending", "body_bending.frequency", "Hz", &[6.0, 12.0]),
    ("body_bending", "body_bending.modal_mass", "kg", &[5000.0, 12000.0]),
    ("body_bending", "body_bending.damping_ratio", "-", &[0.01, 0.05]),
    ("body_bending", "body_bending.shape_at_bogies", "-", &[0.3, 0.6]),
    ("bumpstop_gap", "secondary.bumpstop_gap", "m", &[0.0, 0.06]),
    ("yaw_damper_loss", "secondary.yaw_damper_remaining", "-", &[0.0, 1.0]),
    ("centre_friction", "secondary.centre_friction_torque", "N m", &[0.0, 30_000.0]),
    ("payload", "payload.mass", "kg", &[0.0, 12_000.0]),
    ("payload_offset", "payload.lateral_offset", "m", &[-0.2, 0.2]),
    ("anti_roll_bar", "secondary.anti_roll_scale", "-", &[0.0, 2.0]),
    ("primary_yaw_stiffness", "primary.kx_scale", "-", &[0.1, 4.0]),
    ("vertical_damper_loss", "secondary.cz_scale", "-", &[0.0, 1.0]),
    ("lateral_damper_loss", "secondary.cy_scale", "-", &[0.0, 1.0]),
    ("out_of_roundness", "out_of_roundness.wheelset", "-", &[1.0, 4.0]),
    ("out_of_roundness", "out_of_roundness.side", "-", &[-1.0, 0.0, 1.0]),
    ("out_of_roundness", "out_of_roundness.amplitude", "m", &[0.0, 0.002]),
    ("out_of_roundness", "out_of_roundness.harmonic", "-", &[1.0, 6.0]),
    ("track_irregularity_scale", "track.irregularity_scale", "-", &[0.5, 2.5]),
    ("cant_error", "track.cant_error", "mm", &[-60.0, 60.0]),
    ("crosswind", "crosswind.force", "N", &[-30_000.0, 30_000.0]),
    ("crosswind", "crosswind.height", "m", &[2.2, 2.6]),
    ("sensor_gain", "measurement.gain.<channel>", "-", &[0.6, 1.0, 1.5]),
    ("sensor_offset", "measurement.offset.<channel>", "-", &[-20.0, -1.0, 0.0, 1.0, 20.0]),
    ("sync_shift", "measurement.shift", "m", &[-40.0, 0.0, 40.0]),
    ("filter_mismatch", "measurement.lowpass", "Hz", &[1.0, 15.0]),
    ("channel_swap", "measurement.swap", "-", &[0.0, 1.0]),
    ("polarity", "measurement.polarity.<channel>", "-", &[-1.0, 1.0]),
    ("crosstalk", "measurement.crosstalk", "-", &[0.0, 0.15]),
    ("sensor_drift", "measurement.drift.<channel>", "1/s", &[0.0]),
    ("sensor_noise", "measurement.noise.<channel>", "-", &[0.0]),
];

fn parameters(catalogue: &Catalogue) -> impl Iterator<Item = (&Effect, &Parameter)> {
    catalogue
        .effects
        .iter()
        .flat_map(|effect| effect.parameters.iter().map(move |parameter| (effect, parameter)))
}

#[test]
fn every_effect_that_was_asked_for_is_there() {
    let catalogue = catalogue();
    for (effect, name, unit, values) in ASKED {
        let found = catalogue.effect(effect).unwrap_or_else(|| panic!("no {effect}"));
        let parameter = found
            .parameters
            .iter()
            .find(|known| known.name == name)
            .unwrap_or_else(|| panic!("{effect} has no {name}"));
        assert_eq!(parameter.unit, Unit::parse(unit).expect("a unit"), "{name}");
        for value in values {
            assert!(
                (parameter.low..=parameter.high).contains(value),
                "{name}: {value} is outside {} to {}",
                parameter.low,
                parameter.high
            );
        }
    }
}

/// What a simulator adds names a parameter of the model, in a unit of the same kind; what the chain
/// adds needs none.
#[test]
fn every_parameter_reaches_the_model() {
    let catalogue = catalogue();
    for (effect, parameter) in parameters(&catalogue) {
        assert!(
            !effect.means.is_empty() && !parameter.meaning.is_empty() && !effect.title.is_empty(),
            "{}: in words",
            parameter.name
        );
        assert_eq!(
            effect.acts == Acts::MeasuringChain,
            parameter.model.is_none(),
            "{}",
            parameter.name
        );
        if let Some((key, factor)) = &parameter.model {
            let known = PARAMETERS
                .iter()
                .find(|known| known.key == key)
                .unwrap_or_else(|| panic!("no {key}"));
            let (written, model) = (&parameter.unit, Unit::parse(known.unit).expect("a unit"));
            assert_eq!(written.dimension, model.dimension, "{key}");
            assert!((written.factor / model.factor - factor).abs() < 1e-12, "{key}");
        }
        let inside = parameter.low..=parameter.high;
        assert!(inside.contains(&parameter.default), "{}: default", parameter.name);
        assert!(
            parameter.neutral.is_none_or(|neutral| inside.contains(&neutral)),
            "{}: neutral",
            parameter.name
        );
        for fit in &effect.fits {
            assert!(
                fit.axes
                    .iter()
                    .all(|(at, values)| *at < effect.parameters.len() && values.len() > 1
                        || values.len() == 1),
                "fit"
            );
        }
    }
}

/// Each effect of the simulator at the values of the vehicle file gives the same bytes as none.
#[test]
fn neutral_values_give_identical_records() {
    let place = Place::new();
    place.simulated("plain", &[]);
    let mut problems = Problems::default();
    let campaign =
        fishplate::data::Campaign::open(&place.path("small"), &mut problems).expect("a campaign");
    let catalogue = catalogue();
    let mut arguments = Vec::new();
    for (effect, parameter) in
        parameters(&catalogue).filter(|(_, parameter)| parameter.model.is_some())
    {
        let (key, _) = parameter.model.as_ref().expect("a parameter of the model");
        let written = campaign
            .vehicle
            .lookup(key)
            .and_then(|node| node.scalar_text())
            .unwrap_or_else(|| panic!("no {key}"));
        // The number without its unit, which is that of the parameter.
        let written = written.split(' ').next().unwrap_or_default();
        // Some are neutral outside of what is plausible for the effect: rigid bodies have no
        // frequency.
        let plausible = written
            .parse()
            .is_ok_and(|value: f64| (parameter.low..=parameter.high).contains(&value));
        if plausible || written == "both" {
            arguments.extend([
                "--effect".to_string(),
                format!("{}.{}={written}", effect.name, parameter.name),
            ]);
        }
    }
    assert!(arguments.len() > 40, "{}", arguments.len());
    place.simulated("neutral", &arguments.iter().map(String::as_str).collect::<Vec<_>>());
    for section in SECTIONS {
        let record = format!("simulation/{section}.csv");
        assert!(place.text(&format!("plain/{record}")) == place.text(&format!("neutral/{record}")));
    }
}

/// Each effect of the simulator at its default changes some record.
#[test]
fn every_effect_does_something() {
    let place = Place::new();
    place.simulated("plain", &[]);
    for effect in catalogue().effects.iter().filter(|effect| effect.acts != Acts::MeasuringChain) {
        let out = format!("with-{}", effect.name);
        place.simulated(&out, &["--effect", &effect.name]);
        let changed = SECTIONS.iter().filter(|section| {
            let record = format!("simulation/{section}.csv");
            place.text(&format!("plain/{record}")) != place.text(&format!("{out}/{record}"))
        });
        assert!(changed.count() > 0, "{}", effect.name);
    }
}
