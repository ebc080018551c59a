"""Parameters of designs and scenes that the axes of a sweep name, and what a point changes in them.

The name of an axis is dotted, such as `skin.width_mm`, `fingers.thumb.skin.width_mm` for a finger
of a set, or `scene.seed` for the scene.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from fingertip.catalogues.electronics import split_finger
from fingertip.design.geometry import DesignTables
from fingertip.design.parameters import ELECTRONIC_TABLES, ParameterTable, declaration
from fingertip.foundation.errors import Issue, SweepError
from fingertip.sweep.axes import Value

_SCENE = "scene."
"""Beginning of the name of a scene's parameter."""


@dataclass(frozen=True)
class SweptParameter:
    """Parameter that an axis sweeps."""

    model: type[BaseModel]
    """Model of the design or of the scene."""
    path: str
    """Dotted name within the model."""

    @property
    def field(self) -> FieldInfo:
        """Field that declares the parameter."""
        table, _, key = self.path.rpartition(".")
        section = self.model.model_fields[table].annotation if table else self.model
        assert isinstance(section, type)
        assert issubclass(section, BaseModel)

        return section.model_fields[key]

    def check_value(self, value: Value) -> list[str]:
        """Return what is wrong with a value, as the field alone tells.

        Rules between parameters are checked at each point of a sweep.
        """
        table, _, key = self.path.rpartition(".")
        tables: dict[str, Any] = {table: {key: value}} if table else {key: value}
        validator = self.model.__pydantic_validator__

        try:
            validator.validate_python(tables, self_instance=self.model.model_construct())
        except ValidationError as error:
            issues = declaration.issues_from_pydantic(error, self.model)
            return [issue.message for issue in issues]

        return []


def find_parameter(name: str) -> SweptParameter:
    """Find the parameter that an axis names. Raises SweepError if there is none."""
    if name.startswith(_SCENE):
        path = name.removeprefix(_SCENE)
        model = _load_scene_models()[0]
    else:
        path = split_finger(name)[1]
        model = DesignTables

    if path not in list_parameter_names(model):
        raise SweepError(Issue(f"axes.{name}", _explain_unknown(name, path)))

    return SweptParameter(model, path)


def _explain_unknown(name: str, path: str) -> str:
    """Explain why an axis names no parameter, and what to name instead."""
    scene, manipulation = _load_scene_models()
    if name.startswith(_SCENE) and path in list_parameter_names(manipulation):
        return (
            "is a parameter of a manipulation, but a sweep simulates scenes of one finger; "
            "use `fingertip simulate` with --set for a manipulation."
        )

    retired = declaration.load_retired()
    if path in retired:
        return retired[path]

    known = list_parameter_names(DesignTables) + list_parameter_names(scene, _SCENE)
    similar = declaration.find_similar_name(name, known)
    if similar:
        return f"there is no such parameter; did you mean {similar}?"

    # The list of all names would be too long for a message.
    return "there is no such parameter; `fingertip params` lists the names of a design."


def list_parameter_names(model: type[BaseModel], prefix: str = "") -> list[str]:
    """List the dotted names of all parameters of a design or a scene, each with a prefix."""
    names = []
    for name, field in model.model_fields.items():
        if isinstance(field.default, ParameterTable):
            names += [f"{prefix}{name}.{key}" for key in type(field.default).model_fields]
        elif get_origin(field.annotation) is not list:
            names.append(f"{prefix}{name}")

    return names


def _load_scene_models() -> tuple[type[BaseModel], type[BaseModel]]:
    """Load the models of a scene and of a manipulation.

    They import the whole simulation, which most sweeps do not use.
    """
    from fingertip.sim.runs.scene_and_manipulation_files import ManipulationFile, SceneFile  # noqa: PLC0415

    return SceneFile, ManipulationFile


def select_changes(parameters: Mapping[str, Value], finger: str = "") -> dict[str, Value]:
    """Select what a point changes in a design, or in a finger of a set.

    A finger's own parameters take precedence over those of all fingers.
    """
    of_all_fingers: dict[str, Value] = {}
    of_this_finger: dict[str, Value] = {}

    for name, value in parameters.items():
        owner, path = split_finger(name)
        if name.startswith(_SCENE):
            continue

        if not owner:
            of_all_fingers[path] = value
        elif owner == finger:
            of_this_finger[path] = value

    return of_all_fingers | of_this_finger


def is_of_parts(name: str) -> bool:
    """Return whether the shape of parts may depend on the parameter of an axis."""
    table = split_finger(name)[1].partition(".")[0]
    return table not in {*ELECTRONIC_TABLES, "scene"}
