//! The table of blocks and fields.

use super::{
    Key, Kind,
    fields::{
        CLAUSE, FOR_EACH, NOTE, OPTIONAL, PARAPHRASE, SOURCE, UNCONFIRMED, WORDS, list, many,
        pattern, phrase, text,
    },
};

/// A kind of block with a name, of which a protocol has any number.
const VERDICT_OUTCOME: Key = many(phrase(
    "outcome",
    "In place of two words: outcomes in order, the best first. The first whose rule is met is that of the verdict; each says whether the verdict then `holds` or `fails`. The last has no rule.",
    "validated with restriction: holds when at least 11 quantities hold",
));

const fn block(
    word: &'static str,
    group: &'static str,
    about: &'static str,
    keys: &'static [Key],
) -> Kind {
    Kind { word, group, named: true, single: false, about, keys }
}

/// Every kind of block, in the order of the canonical text.
pub const KINDS: &[Kind] = &[
    Kind {
        single: true,
        ..block(
            "protocol",
            "protocol",
            "The identification of the protocol. Other protocols extend it by its name.",
            &[
                phrase(
                    "extends",
                    "The parent protocol. Its rules apply unless overridden by name. Write the name of a shipped protocol, or a path relative to this file in quotes.",
                    "en14363-2016-annex-t",
                ),
                many(phrase(
                    "uses",
                    "A text without quantities whose rules the protocol shares with others. Its own rules of the same names change them field by field. Write the name of a shipped text, or a path relative to this file in quotes.",
                    "plausibility-signals",
                )),
                text("edition", "The standard and its edition.", "EN 14363:2016, Annex T"),
                SOURCE,
                text("author", "The author of the protocol.", "Working group 10"),
                text(
                    "scope",
                    "The purpose, in one or two sentences.",
                    "Models for on-track tests of vehicles with bogies.",
                ),
                phrase(
                    "axis",
                    "The channel that sections are cut along and plots are drawn over.",
                    "distance in m",
                ),
                phrase(
                    "time",
                    "The channel with the time of the samples. Filters need it.",
                    "time in s",
                ),
                many(text(
                    "leaves out",
                    "What the protocol does not do of its standard. The report lists it under the deviations.",
                    "The assessment of bogie-frame accelerations.",
                )),
                NOTE,
            ],
        )
    },
    Kind {
        single: true,
        named: false,
        ..block(
            "remove",
            "remove",
            "In a variant: rules of the parent that do not apply.",
            &[
                many(phrase(
                    "quantity",
                    "A quantity of the parent, a family as written there, or `every` for all.",
                    "az_max",
                )),
                many(phrase("zone", "A zone of the parent, a family, or `every` for all.", "4")),
                many(phrase(
                    "check",
                    "A section check of the parent, a family, or `every` for all.",
                    "full_curve",
                )),
                many(phrase(
                    "plausibility",
                    "A plausibility rule of the parent, a family, or `every` for all.",
                    "wheel_load",
                )),
                many(phrase(
                    "find",
                    "A condition on found sections of the parent, a family, or `every` for all.",
                    "steady_speed",
                )),
                many(phrase("domain", "A domain of the parent, or `every` one.", "application")),
                many(phrase(
                    "verdict",
                    "A named verdict of the parent, a family, or `every` for all.",
                    "inspection",
                )),
                many(phrase(
                    "limit",
                    "Limits of a quantity of the parent, of a family or of `every` quantity: write the quantity, then the statistic, or no statistic for all limits.",
                    "az_max mean",
                )),
            ],
        )
    },
    block(
        "parameter",
        "parameters",
        "A number or a choice that a campaign, a variant or the command line can set.",
        &[
            FOR_EACH,
            phrase(
                "default",
                "The default value: a number with its unit, or one of the choices.",
                "20 Hz",
            ),
            OPTIONAL,
            list(phrase(
                "one of",
                "The possible words of a choice.",
                "oriented, signed, magnitudes",
            )),
            phrase("range", "The smallest and the largest allowed value.", "10 Hz to 40 Hz"),
            phrase(
                "at",
                "The place whose positions are selected. The default is then a list of positions.",
                "wheelset",
            ),
            UNCONFIRMED,
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "place",
        "places",
        "A set of positions on the vehicle at which channels are measured.",
        &[
            list(phrase("members", "The positions, as they appear in channel names.", "R, L")),
            many(phrase(
                "alias",
                "A name for a position that depends on the section.",
                "outer is L when direction is right, R when direction is left",
            )),
            NOTE,
        ],
    ),
    block(
        "vehicle",
        "vehicle data",
        "A value of the vehicle file. Rules use it as `vehicle.<name>`.",
        &[
            FOR_EACH,
            phrase("in", "The unit of a number.", "kN"),
            list(phrase(
                "one of",
                "The possible words of a choice; `any word` where the protocol does not list them.",
                "passenger, locomotive, freight",
            )),
            phrase(
                "key",
                "The key in the vehicle file, if it differs from the name.",
                "static_wheel_load",
            ),
            phrase(
                "range",
                "The smallest and the largest allowed value of a number.",
                "10 kN to 200 kN",
            ),
            phrase(
                "default",
                "The value if the file has none. Without a default, the file must have it.",
                "40 t",
            ),
            OPTIONAL,
            NOTE,
        ],
    ),
    block(
        "section",
        "section data",
        "A column of the table of sections, or a value computed from others. Rules use it by its name.",
        &[
            FOR_EACH,
            phrase("in", "The unit of a number.", "m"),
            list(phrase(
                "one of",
                "The possible words of a choice; `zones` stands for the names of all zones, `any word` for words that the protocol does not list.",
                "right, left, straight",
            )),
            text(
                "column",
                "The column header without the unit, if it differs from the name with blanks for underscores.",
                "cant deficiency",
            ),
            phrase(
                "default",
                "The value of an empty cell. Without a default, an empty cell is a missing value.",
                "0 mm",
            ),
            OPTIONAL,
            phrase(
                "found",
                "The value of a section that is found in a run: an expression of values of its signals and of other section data.",
                "1 / |mean of curvature| when direction is not straight",
            ),
            phrase(
                "is",
                "The value, computed from other section data and vehicle data. The table of sections then has no such column.",
                "low when conicity < 0.1, medium when conicity < 0.25, otherwise high",
            ),
            NOTE,
        ],
    ),
    block(
        "record",
        "records",
        "A name for records of which a campaign has several: some of its simulations or measured runs.",
        &[
            phrase(
                "is",
                "`simulated` or `measured`, and the names that the campaign gives to these records; all of the side without names.",
                "simulated simpack, vampire",
            ),
            NOTE,
        ],
    ),
    block(
        "channel",
        "channels",
        "A measured and simulated signal, with one column of the records for each position.",
        &[
            FOR_EACH,
            phrase(
                "in",
                "The unit of printed values. Columns in other units of the same dimension are converted.",
                "kN",
            ),
            phrase("at", "The places at which it is measured.", "each wheelset and side"),
            pattern(text(
                "column",
                "The column header without the unit, with places in braces.",
                "Y_{wheelset}{side}",
            )),
            phrase(
                "record",
                "The kind of record that contains it, if not simulation and measurement: `track`.",
                "track",
            ),
            OPTIONAL,
            NOTE,
        ],
    ),
    block(
        "signal",
        "signals",
        "A signal computed from channels and other signals, sample by sample.",
        &[
            FOR_EACH,
            phrase("is", "The expression.", "Y at side R + Y at side L"),
            phrase(
                "at",
                "The places at which it exists, without those that the expression fixes.",
                "each wheelset",
            ),
            phrase("in", "The unit of printed values.", "kN"),
            pattern(text(
                "named",
                "The name of a position in tables, with places in braces.",
                "SigmaY_{wheelset}",
            )),
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "filter",
        "filters",
        "A chain of filter steps with a name.",
        &[
            FOR_EACH,
            many(phrase(
                "step",
                "One step of the chain, in order.",
                "low-pass 20 Hz, order 4, zero-phase",
            )),
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "define",
        "definitions",
        "A name for an expression: a condition, a factor, a table by zone or speed.",
        &[
            FOR_EACH,
            phrase("of", "The names of its arguments, if it is a function.", "x, scale"),
            phrase(
                "is",
                "The expression.",
                "vehicle.category is freight or not vehicle.secondary_suspension",
            ),
            UNCONFIRMED,
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "zone",
        "zones",
        "A test zone: a class of sections.",
        &[
            FOR_EACH,
            phrase(
                "where",
                "The condition that a section of the zone must satisfy.",
                "400 m <= radius <= 600 m",
            ),
            phrase("minimum sections", "The number of used sections that the zone needs.", "3"),
            phrase(
                "minimum length",
                "The minimum length of a section.",
                "250 m when admissible_speed <= 220 km/h, otherwise 500 m",
            ),
            UNCONFIRMED,
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "check",
        "checks",
        "A requirement on every section. A section that does not meet it is not used.",
        &[
            FOR_EACH,
            phrase(
                "require",
                "The condition on the data of the section and on values of its signals.",
                "range of curvature <= 5 % * |mean of curvature|",
            ),
            phrase("unless", "Sections that do not need to satisfy it.", "direction is straight"),
            phrase(
                "otherwise",
                "The treatment of a section that does not meet it: `not used` (the default), `note` or `stop`.",
                "note",
            ),
            phrase(
                "unchecked",
                "The treatment of a section in which it cannot be checked: `not assessable` (the default), or `note`, also if `otherwise` is `note`.",
                "note",
            ),
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "plausibility",
        "plausibility",
        "A condition that sound data satisfy. A violation is reported as a finding, with the value and the expected value.",
        &[
            FOR_EACH,
            many(phrase(
                "of",
                "Signals and the positions at which the rule is checked. Positions that were not recorded are skipped.",
                "SigmaQ at each wheelset",
            )),
            phrase("filter", "Filters in order, as in a quantity.", "BP"),
            phrase(
                "require",
                "The condition. It is checked for simulation and measurement separately, or for both together where it names a metric or a side.",
                "median near 2 * Q0 within a factor of 1.4",
            ),
            phrase(
                "over",
                "`sections`: all sections meet the condition together, and not each: the median of their values, with its uncertainty. `order of sections`: their change from the first section of the table to the last.",
                "sections",
            ),
            phrase(
                "slope",
                "With `over sections` and `near`: between which numbers the slope of the values found over those expected must lie.",
                "0.9 to 1.1",
            ),
            list(phrase(
                "distinct",
                "In place of a condition: signals that must not have the same samples.",
                "channels, sections, sides",
            )),
            phrase(
                "exchanged",
                "In place of a condition: from which correlation on a measured record or channel is reported that agrees with the simulation of another section or channel, and by how much more than with its own; and from which one on two measurements are alike.",
                "from 0.6, by 0.3, alike from 0.7",
            ),
            phrase(
                "concerns",
                "What a finding is about: `channel` (the default), or `record`: one at half of the positions or more is a fault of the whole record, and explains other findings in its sections.",
                "record",
            ),
            phrase("unless", "Sections that do not need to satisfy it.", "direction is straight"),
            phrase(
                "otherwise",
                "The consequence of a finding: `note` (the default), `not used` (the section), `not assessable` (the campaign) or `stop`.",
                "not used",
            ),
            text(
                "cause",
                "The probable cause of a finding.",
                "the load of an axle in place of that of a wheel",
            ),
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    Kind {
        single: true,
        named: false,
        ..block(
            "sections",
            "sections",
            "The treatment of sections.",
            &[
                phrase(
                    "use",
                    "`sections` (cut from the records by the table of sections), `found sections` (looked for in the runs of the campaign) or `whole records` (no sections).",
                    "sections",
                ),
                phrase("zone", "The section column with the zone, if there are zones.", "zone"),
                phrase(
                    "where",
                    "Only sections that satisfy this condition are used.",
                    "speed >= 60 km/h",
                ),
                phrase(
                    "faulty",
                    "The consequence of a faulty record: `not used` (the section, with the reason) or `stop`.",
                    "not used",
                ),
                phrase(
                    "minimum",
                    "The total number of used sections that the campaign needs.",
                    "12",
                ),
                phrase(
                    "removed",
                    "The share of the sections that may be removed: not used for what their data or records are. With more, the verdict is not assessable.",
                    "at most 20 %",
                ),
                phrase(
                    "step",
                    "Of found sections: the distance between two places that are tried.",
                    "1 m",
                ),
                phrase(
                    "length",
                    "Of found sections: their length. Without this field, the minimum length of the zone.",
                    "250 m when speed > 140 km/h, otherwise 100 m",
                ),
                phrase(
                    "prefer",
                    "Of found sections that would overlap: `first` (the default), or the one with the highest value of an expression.",
                    "std of ay at running_gear I",
                ),
                phrase(
                    "margin",
                    "Of found sections: the record that there must be on each side. The default is the length of the section.",
                    "30 m",
                ),
                phrase(
                    "keep",
                    "Reduces the sections: at most this number for each zone or word of section data, so that the highest standard deviation stays almost the same.",
                    "at most 9 for each zone and country",
                ),
                many(phrase(
                    "report",
                    "A number of the data of the sections used, of all or of each group: it is printed and decides nothing.",
                    "total of length in km for each zone",
                )),
                phrase(
                    "percentiles",
                    "The interpolation rule of percentiles, by the name of Hyndman & Fan.",
                    "linear",
                ),
                NOTE,
            ],
        )
    },
    block(
        "find",
        "find",
        "A condition on every section that is found in a run. The conditions are tried in the order of the text.",
        &[
            FOR_EACH,
            phrase(
                "require",
                "The condition on values of signals and on the data of the section.",
                "range of running_speed <= 2 km/h",
            ),
            phrase("lead", "How far before the section its signals are looked at too.", "30 m"),
            phrase("tail", "How far behind the section its signals are looked at too.", "15 m"),
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "domain",
        "domains",
        "Which wanted operation lies inside what the sections cover: the convex hull of section data.",
        &[
            phrase(
                "over",
                "What spans it: section data or expressions of them, each `in` the unit it is printed in; `for each` word of the table a hull of its own.",
                "speed, cant_deficiency, curvature in 1/km for each state",
            ),
            phrase(
                "otherwise",
                "What wanted operation outside does: `note` (the default), or `not assessable` (the campaign).",
                "not assessable",
            ),
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "quantity",
        "quantities",
        "A validation quantity: its signals, their processing, the comparison and the limits.",
        &[
            FOR_EACH,
            phrase(
                "like",
                "Another quantity whose fields hold here, except those that are given.",
                "SigmaY_max",
            ),
            text("symbol", "The symbol in tables.", "(Y/Q)max"),
            many(phrase(
                "of",
                "The signal and the positions at which it is evaluated, with `when` for a condition on the section. Several fields are possible.",
                "Y at wheelsets 1, 3",
            )),
            phrase(
                "filter",
                "Filters in order: names or steps.",
                "LP20, then sliding mean 2 m every 0.5 m",
            ),
            phrase(
                "from",
                "In place of a comparison: the records whose values are assessed: `simulated`, `measured`, or a declared record.",
                "measured",
            ),
            many(phrase(
                "value",
                "The value taken from the filtered signal of a section, for each record alike. Of several values, those whose case applies are used.",
                "larger of |p0.15|, |p99.85|",
            )),
            phrase(
                "compare",
                "The records that are compared: `simulated with measured` (the default), each record with the mean or median of all (`simulated with mean of simulated`), `measured with each other`, or `repeats with originals`. The name of a declared record may stand for a side.",
                "simulated with mean of simulated",
            ),
            phrase("difference", "The difference of the two values.", "|simulated| - |measured|"),
            phrase(
                "metric",
                "In place of value and difference: one number computed from both signals.",
                "sprague-geers magnitude",
            ),
            many(phrase(
                "limit",
                "A statistic or estimate over all values, or over those of each group, and its limit.",
                "std 9 kN",
            )),
            many(phrase(
                "report",
                "A statistic or estimate without a limit, over all values or those of each group: it is printed and decides nothing.",
                "maximum for each zone and wheelset",
            )),
            many(phrase(
                "outcome",
                "Outcomes in order, the best first: the first whose condition on estimates is met is that of the quantity. Each says whether the quantity then `holds` or `fails`; the last has no condition.",
                "good: holds when mean <= 2",
            )),
            text(
                "reported",
                "Why it has no limit: it is reported, and decides nothing.",
                "A factor of the metric above.",
            ),
            phrase("minimum signals", "The number of signals that it needs.", "2"),
            many(phrase(
                "minimum pairs",
                "The number of section x signal pairs that it needs: in all, or in each group (`3 for each zone and wheelset`).",
                "24",
            )),
            phrase("in", "The unit of printed values, if it is not that of the signal.", "kN"),
            phrase(
                "where",
                "Only sections that satisfy this condition are used.",
                "direction is not straight",
            ),
            UNCONFIRMED,
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    block(
        "clause",
        "clauses",
        "A clause of the standard that no rule stands for, or not wholly; its title says what it asks for, in own words.",
        &[
            text("clause", "The clause, as in the field of rules.", "49 CFR 213, Appendix D"),
            text(
                "judged by",
                "Who judges what no rule computes. Without it, the clause is not covered.",
                "the person in charge of the test",
            ),
            NOTE,
        ],
    ),
    block(
        "estimate",
        "estimates",
        "A name for an estimate from the values of a group: an expression of statistics, regressions and shares.",
        &[
            FOR_EACH,
            phrase("is", "The expression.", "mean + 3 * std"),
            UNCONFIRMED,
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
    Kind {
        single: true,
        named: false,
        ..block(
            "verdict",
            "verdict",
            "The rule of the overall verdict, and how quantities are counted.",
            &[
                phrase(
                    "validated",
                    "`when every limit holds` (the default), `when at least N quantities hold`, both also `in 95 % of draws`, or a rule over named verdicts.",
                    "when every limit holds",
                ),
                WORDS,
                phrase(
                    "minimum signals",
                    "The number of signals that a quantity needs, unless the quantity states it.",
                    "2",
                ),
                many(phrase(
                    "minimum pairs",
                    "The number of section x signal pairs that a quantity needs, in all or in each group, unless the quantity states it.",
                    "24",
                )),
                VERDICT_OUTCOME,
                phrase("standard deviation", "Divisor of the variance: `n-1` or `n`.", "n-1"),
                phrase(
                    "independent",
                    "The independent unit: `site` (the default), `section`, `campaign`, or a section column. It is used for counts, for n and for confidence intervals.",
                    "site",
                ),
                NOTE,
            ],
        )
    },
    block(
        "verdict",
        "verdicts",
        "A verdict with a name: from limits of quantities, from other verdicts, or by a person.",
        &[
            FOR_EACH,
            list(phrase(
                "of",
                "The quantities whose limits count: names, or `measured`, `simulated` or `compared` for all of a kind. Without this field, all quantities.",
                "SigmaY, YQ, Q",
            )),
            phrase(
                "holds",
                "`when every limit holds`, `when at least N quantities hold`, both also `in 95 % of draws`, or a rule over other verdicts.",
                "when virtual_test is measured_test",
            ),
            VERDICT_OUTCOME,
            text(
                "judged by",
                "In place of `holds`: the person who decides. The program gives no verdict; the report has lines for the judgement.",
                "the responsible test engineer",
            ),
            WORDS,
            CLAUSE,
            PARAPHRASE,
            SOURCE,
            NOTE,
        ],
    ),
];
