//! Which blocks and fields a protocol may hold: one table for both surfaces, the JSON Schema and the language reference.

use super::document::Block;

/// How the value of a field is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// Prose: quoted in the text form, a plain string in YAML.
    Text,
    /// Words of the language: the same in both forms.
    Phrase,
}

/// A field of a block.
#[derive(Debug)]
pub struct Key {
    pub word: &'static str,
    pub sort: Sort,
    /// May stand more than once (a list in YAML).
    pub many: bool,
    /// A text in which places of the vehicle stand in braces.
    pub pattern: bool,
    pub about: &'static str,
    pub example: &'static str,
}

/// A kind of block.
#[derive(Debug)]
pub struct Kind {
    /// As in the text form: `quantity`.
    pub word: &'static str,
    /// As in YAML: `quantities`.
    pub group: &'static str,
    pub named: bool,
    /// Whether a protocol has at most one such block (in YAML its fields then stand right below the group).
    pub single: bool,
    pub about: &'static str,
    pub keys: &'static [Key],
}

const fn text(word: &'static str, about: &'static str, example: &'static str) -> Key {
    Key { word, sort: Sort::Text, many: false, pattern: false, about, example }
}

const fn phrase(word: &'static str, about: &'static str, example: &'static str) -> Key {
    Key { word, sort: Sort::Phrase, many: false, pattern: false, about, example }
}

const fn many(key: Key) -> Key {
    Key { many: true, ..key }
}

const fn pattern(key: Key) -> Key {
    Key { pattern: true, ..key }
}

/// The word of the field that makes a block a family of blocks.
pub const EACH: &str = "for each";

const FOR_EACH: Key = many(phrase(
    EACH,
    "Makes the block a family: it stands once for each member, which is put in where `{variable}` stands.",
    "channel in Y, Q and part in magnitude, phase",
));
const CLAUSE: Key = text("clause", "Clause of the standard the rule follows.", "Annex T, T.3");
const SOURCE: Key = text("source", "Where the rule or number is published.", "Goetz & Polach, Table 1");
const WORDS: Key = phrase("words", "The two words of the verdict: if it holds, and if it does not.", "accepted, not accepted");
const NOTE: Key = many(text("note", "A remark printed with the rule.", "Absolute values of simulation and measurement."));

/// Every kind of block, in the order of the canonical text.
pub const KINDS: &[Kind] = &[
    Kind {
        word: "protocol",
        group: "protocol",
        named: true,
        single: true,
        about: "What the protocol is. Its name is the name by which others extend it.",
        keys: &[
            phrase(
                "extends",
                "The protocol whose rules hold here unless overridden by name: a shipped name, or a path beside this file in quotes.",
                "en14363-2016-annex-t",
            ),
            text("edition", "The standard and edition it follows.", "EN 14363:2016, Annex T"),
            SOURCE,
            text("author", "Who wrote the protocol.", "Working group 10"),
            text("scope", "What it is for, in a sentence or two.", "Models for on-track tests of vehicles with bogies."),
            phrase("axis", "The channel along which records run: sections are cut on it, plots are drawn over it.", "distance in m"),
            phrase("time", "The channel with the time of the samples, which filters need.", "time in s"),
            NOTE,
        ],
    },
    Kind {
        word: "remove",
        group: "remove",
        named: false,
        single: true,
        about: "In a variant: what of the parent does not hold here.",
        keys: &[
            many(phrase("quantity", "A quantity of the parent, a family of them as it is written there, or `every` one.", "az_max")),
            many(phrase("zone", "A zone of the parent, a family, or `every` one.", "4")),
            many(phrase("check", "A section check of the parent, a family, or `every` one.", "full_curve")),
            many(phrase("plausibility", "A plausibility rule of the parent, a family, or `every` one.", "wheel_load")),
            many(phrase("verdict", "A named verdict of the parent, a family, or `every` one.", "inspection")),
            many(phrase(
                "limit",
                "Limits of a quantity of the parent, of a family or of `every` one: the quantity, then the statistic unless all are meant.",
                "az_max mean",
            )),
        ],
    },
    Kind {
        word: "parameter",
        group: "parameters",
        named: true,
        single: false,
        about: "A number or choice that a campaign, a variant or the command line can set.",
        keys: &[
            FOR_EACH,
            phrase("default", "Its value unless set: a number with its unit, or one of the choices.", "20 Hz"),
            phrase("one of", "The choices, if it is one.", "oriented, signed, magnitudes"),
            phrase("range", "The smallest and largest value allowed.", "10 Hz to 40 Hz"),
            phrase(
                "at",
                "The place whose positions it selects, if it is a selection: then its default is a list of positions.",
                "wheelset",
            ),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "place",
        group: "places",
        named: true,
        single: false,
        about: "A set of positions on the vehicle that channels are measured at.",
        keys: &[
            phrase("members", "The positions, as they appear in channel names.", "R, L"),
            many(phrase(
                "alias",
                "A name for a position that depends on the section.",
                "outer is L when direction is right, R when direction is left",
            )),
            NOTE,
        ],
    },
    Kind {
        word: "vehicle",
        group: "vehicle data",
        named: true,
        single: false,
        about: "A value of the vehicle file that rules refer to as `vehicle.<name>`.",
        keys: &[
            FOR_EACH,
            phrase("in", "Its unit, if it is a number.", "kN"),
            phrase("one of", "Its possible words, if it is one.", "passenger, locomotive, freight"),
            phrase("key", "Where it stands in the vehicle file, if not under its own name.", "static_wheel_load"),
            phrase("range", "The smallest and largest value allowed, if it is a number.", "10 kN to 200 kN"),
            phrase(
                "default",
                "Its value where the file has none; without a default it must be there. `not stated`: it may be absent and has no value then.",
                "not stated",
            ),
            NOTE,
        ],
    },
    Kind {
        word: "section",
        group: "section data",
        named: true,
        single: false,
        about: "A column of the table of sections that rules refer to by its name.",
        keys: &[
            FOR_EACH,
            phrase("in", "Its unit, if it is a number.", "m"),
            phrase("one of", "Its possible words, if it is one; `zones` stands for the names of all zones.", "right, left, straight"),
            text("column", "Its column header without the unit, if not its own name with blanks for underscores.", "cant deficiency"),
            phrase("default", "Its value where the cell is empty; without a default an empty cell is a missing value.", "0 mm"),
            NOTE,
        ],
    },
    Kind {
        word: "channel",
        group: "channels",
        named: true,
        single: false,
        about: "A measured and simulated signal, one column of the records for each position.",
        keys: &[
            FOR_EACH,
            phrase("in", "The unit in which its values are printed; columns in other units of the same dimension are converted.", "kN"),
            phrase("at", "The places it is measured at.", "each wheelset and side"),
            pattern(text("column", "Its column header without the unit; places in braces.", "Y_{wheelset}{side}")),
            phrase("record", "The kind of record it stands in, if not in simulation and measurement: `track`.", "track"),
            NOTE,
        ],
    },
    Kind {
        word: "signal",
        group: "signals",
        named: true,
        single: false,
        about: "A signal computed sample by sample from channels and other signals.",
        keys: &[
            FOR_EACH,
            phrase("is", "The expression.", "Y at side R + Y at side L"),
            phrase("at", "The places it exists at; those the expression fixes are left out.", "each wheelset"),
            phrase("in", "The unit in which its values are printed.", "kN"),
            pattern(text("named", "How one of its positions is called in tables; places in braces.", "SigmaY_{wheelset}")),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "filter",
        group: "filters",
        named: true,
        single: false,
        about: "A chain of filter steps with a name.",
        keys: &[
            FOR_EACH,
            many(phrase("step", "One step of the chain, in order.", "low-pass 20 Hz, order 4, zero-phase")),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "define",
        group: "definitions",
        named: true,
        single: false,
        about: "A name for an expression: a condition, a factor, a table by zone or speed.",
        keys: &[
            FOR_EACH,
            phrase("is", "The expression.", "vehicle.category is freight or not vehicle.secondary_suspension"),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "zone",
        group: "zones",
        named: true,
        single: false,
        about: "A test zone: a class of sections.",
        keys: &[
            FOR_EACH,
            phrase("where", "What a section of the zone must satisfy.", "400 m <= radius <= 600 m"),
            phrase("minimum sections", "How many used sections the zone needs.", "3"),
            phrase("minimum length", "How long a section must be.", "250 m when admissible_speed <= 220 km/h, otherwise 500 m"),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "check",
        group: "checks",
        named: true,
        single: false,
        about: "A requirement on every section; a section that fails it is not used.",
        keys: &[
            FOR_EACH,
            phrase(
                "require",
                "The condition on the section's data and on reduced signals of its records.",
                "range of curvature <= 5 % * |mean of curvature|",
            ),
            phrase("unless", "Sections that need not satisfy it.", "direction is straight"),
            phrase("otherwise", "What happens to a section that fails: `not used` (the default), `note` or `stop`.", "note"),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "plausibility",
        group: "plausibility",
        named: true,
        single: false,
        about: "What sound data satisfy. What does not is told as a finding, with the number found and what it should be near.",
        keys: &[
            FOR_EACH,
            many(phrase(
                "of",
                "Signals and the positions at which it is looked at; positions that are not recorded are passed over.",
                "SigmaQ at each wheelset",
            )),
            phrase("filter", "Filters in order, as in a quantity.", "BP"),
            phrase(
                "require",
                "The condition, for simulation and measurement each by itself, or for both where it names a metric or a side.",
                "median near 2 * Q0 within a factor of 1.4",
            ),
            phrase(
                "distinct",
                "In place of a condition: among what no two of the signals may be the same samples.",
                "channels, sections, sides",
            ),
            phrase("unless", "Sections that need not satisfy it.", "direction is straight"),
            phrase(
                "otherwise",
                "What a finding does: `note` (the default), `not used` (its section), `not assessable` (the campaign) or `stop`.",
                "not used",
            ),
            text("cause", "The likely cause of a finding, in words.", "the load of an axle in place of that of a wheel"),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "sections",
        group: "sections",
        named: false,
        single: true,
        about: "How sections are treated.",
        keys: &[
            phrase("use", "`sections` (cut from the records by the table of sections) or `whole records` (no sections).", "sections"),
            phrase("zone", "The section column with the zone, if there are zones.", "zone"),
            phrase("where", "Only sections that satisfy this are used.", "speed >= 60 km/h"),
            phrase("faulty", "What a faulty record does: `not used` (its section, with the reason) or `stop`.", "not used"),
            phrase("minimum", "How many used sections the campaign needs in all.", "12"),
            phrase("percentiles", "How percentiles are read between samples: a rule of Hyndman & Fan by name.", "linear"),
            NOTE,
        ],
    },
    Kind {
        word: "quantity",
        group: "quantities",
        named: true,
        single: false,
        about: "A validation quantity: which signals, how processed, how compared, within which limits.",
        keys: &[
            FOR_EACH,
            text("symbol", "As printed in tables.", "(Y/Q)max"),
            many(phrase(
                "of",
                "The signal and the positions at which it is evaluated, `when` the section is so; more than one of them where that differs.",
                "Y at wheelsets 1, 3",
            )),
            phrase("filter", "Filters in order: names, or steps.", "LP20, then sliding mean 2 m every 0.5 m"),
            phrase("from", "In place of a comparison: the record whose values are assessed by themselves.", "measured"),
            many(phrase(
                "value",
                "The number taken from the filtered signal of a section, of each record alike. More than one of them: those whose case applies.",
                "larger of |p0.15|, |p99.85|",
            )),
            phrase(
                "compare",
                "Which records are compared: `simulated with measured` (the default), each with the mean or median of all (`simulated with mean of simulated`), or `repeats with originals`.",
                "simulated with mean of simulated",
            ),
            phrase("difference", "How the two numbers are compared.", "|simulated| - |measured|"),
            phrase("metric", "In place of value and difference: one number from the two signals.", "sprague-geers magnitude"),
            many(phrase("limit", "A statistic or estimate over all values, or over those of each group, and its limit.", "std 9 kN")),
            phrase("minimum signals", "How many signals it needs.", "2"),
            phrase("minimum pairs", "How many section x signal pairs it needs.", "24"),
            phrase("in", "The unit in which its values are printed, if not that of its signal.", "kN"),
            phrase("where", "Only sections that satisfy this are used for it.", "direction is not straight"),
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
    Kind {
        word: "estimate",
        group: "estimates",
        named: true,
        single: false,
        about: "A name for what is estimated from the values of a group: an expression of statistics, regressions, shares.",
        keys: &[phrase("is", "The expression.", "mean + 3 * std"), CLAUSE, SOURCE, NOTE],
    },
    Kind {
        word: "verdict",
        group: "verdict",
        named: false,
        single: true,
        about: "When a model is validated, and how quantities are counted.",
        keys: &[
            phrase(
                "validated",
                "`when every limit holds` (the default), `when at least N quantities hold`, or a rule over named verdicts.",
                "when every limit holds",
            ),
            WORDS,
            phrase("minimum signals", "How many signals a quantity needs unless it says so itself.", "2"),
            phrase("minimum pairs", "How many section x signal pairs a quantity needs unless it says so itself.", "24"),
            phrase("standard deviation", "Divisor of the variance: `n-1` or `n`.", "n-1"),
            phrase(
                "independent",
                "What is independent of each other: `site` (the default), `section`, or a section column. Counts, n and intervals are of it.",
                "site",
            ),
            NOTE,
        ],
    },
    Kind {
        word: "verdict",
        group: "verdicts",
        named: true,
        single: false,
        about: "A verdict with a name: on some quantities, over other verdicts, or left to a person.",
        keys: &[
            FOR_EACH,
            phrase(
                "of",
                "The quantities whose limits count: names, or `measured`, `simulated` or `compared` for all of that kind. All without it.",
                "SigmaY, YQ, Q",
            ),
            phrase(
                "holds",
                "`when every limit holds`, `when at least N quantities hold`, or a rule over other verdicts.",
                "when virtual_test is measured_test",
            ),
            text(
                "judged by",
                "In place of `holds`: who decides. The program never does; the report has lines for the judgement.",
                "the responsible test engineer",
            ),
            WORDS,
            CLAUSE,
            SOURCE,
            NOTE,
        ],
    },
];

/// The kind of block a word of the text form names; of two with the same word, the one without a name.
pub fn kind(word: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.word == word)
}

/// The kind of a block: a `verdict` with a name has other fields than the one without.
pub fn of_block(block: &Block) -> Option<&'static Kind> {
    kind(&block.kind.text).map(|kind| kind.with_name(block.name.is_some()))
}

/// The kind of block a top-level key of the YAML form names.
pub fn group(word: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.group == word)
}

impl Kind {
    /// Whether one block of this kind can stand for a family of them.
    pub fn has_families(&self) -> bool {
        self.key(EACH).is_some()
    }

    /// The kind of the same word that has a name or has none; this one if there is only one of the word.
    pub fn with_name(&'static self, named: bool) -> &'static Self {
        KINDS.iter().find(|kind| kind.word == self.word && kind.named == named).unwrap_or(self)
    }

    pub fn key(&self, word: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.word == word)
    }
}
