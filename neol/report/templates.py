"""The texts of this folder, with values in them."""

import jinja2


def render(template: str, **values: object) -> str:
    """One of the templates here, filled in; what values say is escaped in HTML.

    Raises jinja2.UndefinedError for a name that no value has.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("neol.report", "."),
        autoescape=jinja2.select_autoescape(["html.j2"]),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["short"] = lambda digest: digest[:12]
    return environment.get_template(template).render(values)
