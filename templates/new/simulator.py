"""{{ title }} as a function. Fill in `simulate`, then:

    fishplate diagnose . --effects effects.yaml --simulator sim.yaml --preflight
    fishplate diagnose . --effects effects.yaml --simulator sim.yaml --out report
"""

# The parameters that `simulate` reads: names in vehicle.yaml, which effects.yaml changes.
PARAMETERS = [
{%- for parameter in parameters %}
    "{{ parameter.name }}",
{%- endfor %}
]


def simulate(parameters, inputs):
    """One section: from parameters and inputs to the channels that are compared.

    parameters  a dict of numbers, one for each name above
    inputs      a dict of arrays (NumPy, else lists), and `section`, the row of sections.csv:
{%- for input in inputs %}
                  {{ input.name }} [{{ input.unit }}]
{%- endfor %}
    returns     a dict of arrays of the same length:
{%- for channel in channels %}
                  {{ channel.name }} [{{ channel.unit }}]
{%- endfor %}

    The effects of effects.yaml as terms of the model:
{%- for parameter in parameters %}
      {{ parameter.name }} [{{ parameter.unit }}]: {{ parameter.term }}
{%- endfor %}
    """
    raise NotImplementedError("fill in `simulate` in simulator.py")
