//! A small set of campaigns with withheld truths, made by the generator of
//! `examples/blind_campaigns`, through `fishplate blind`.

use std::fs;

use serde_json::Value;

use super::{fishplate, folder};
use crate::cases::SETS;
use crate::write;

#[test]
fn campaigns_with_withheld_truths_are_diagnosed_and_scored() {
    let (campaigns, out) = (folder().join("withheld"), folder().join("withheld-scores"));
    let set = SETS.iter().find(|set| set.name == "test").unwrap();
    let seed = set.seed.unwrap();
    let written = |case| write::campaign(&campaigns, (set, seed), case).unwrap();
    (set.cases)(seed).iter().for_each(written);
    let resume = folder().join("resume");
    let paths = [&campaigns, &out, &resume].map(|path| path.to_str().unwrap().to_string());
    let ran =
        fishplate(&["blind", &paths[0], "--out", &paths[1], "--resume", &paths[2], "--quiet"]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let blind: Value =
        serde_json::from_str(&fs::read_to_string(out.join("blind.json")).unwrap()).unwrap();
    let cases = blind["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 4);
    let answers: Vec<(&str, String)> = cases
        .iter()
        .map(|case| {
            (
                case["verdict"].as_str().unwrap(),
                case["named"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|name| name.as_str().unwrap())
                    .collect(),
            )
        })
        .collect();
    let expected = [
        ("no significant gap", String::new()),
        ("explained", "friction".to_string()),
        ("explained", "vertical_damper_loss".to_string()),
        ("unexplained", String::new()),
    ];
    assert_eq!(answers, expected, "{blind:#}");
    for case in cases.iter().filter(|case| case["kind"] == "single") {
        assert!(
            case["detectability"].as_f64().unwrap() > 5.0
                && case["first_is_right"].as_bool().unwrap()
        );
        // Relative to what remains of a damper, three tenths; its own tolerance is a tenth of the
        // whole.
        assert!(case["parameter_error"].as_f64().unwrap() < 0.35, "{case:#}");
        let (said, really) =
            (case["shrink_said"].as_f64().unwrap(), case["shrink_true"].as_f64().unwrap());
        assert!((said - really).abs() < 0.1, "{case:#}");
        let cells = |of: &str| case["cells"][of].as_u64().unwrap();
        assert!(cells("both") <= cells("told").min(cells("truly")), "{case:#}");
    }
    // Nothing hidden: no cell is called significant. Outside the catalogue nobody can say which
    // cells are.
    let of_kind = |kind: &str| cases.iter().find(|case| case["kind"] == kind).unwrap();
    assert_eq!(of_kind("none")["cells"], serde_json::json!({"truly": 0, "told": 0, "both": 0}));
    assert!(of_kind("outside")["cells"].is_null());
    assert!(fs::read_to_string(out.join("blind.html")).unwrap().contains("Wilson"));
}
