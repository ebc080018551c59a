"""Command `fingertip completion`: completion scripts for bash, zsh and fish.

The scripts are static: they hold the commands, options and names of this version, so that the tab key need not start
Python. They follow from the same declarations as the help pages.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from fingertip.cli.console import Console, QuietOption, command

SHELLS = ("bash", "zsh", "fish")


@dataclass(frozen=True)
class CommandWords:
    """Words that complete one command."""

    name: str
    """Words of the command, such as "calibrate sensor"."""
    help: str
    flags: tuple[tuple[str, str], ...]
    """Options without a value, each with its meaning."""
    options: tuple[tuple[str, str], ...]
    """Options with a value, each with its meaning."""
    arguments: tuple[str, ...]
    """Names that the arguments may take, beside files."""


@command
def completion(
    context: typer.Context,
    shell: Annotated[str, typer.Argument(help="Shell: bash, zsh or fish.")],
    quiet: QuietOption = False,
) -> None:
    """Print a completion script for a shell: commands, options, bundled names and parameters after --set.

    For bash, add this line to ~/.bashrc: eval "$(fingertip completion bash)". For zsh, add eval "$(fingertip completion
    zsh)" to ~/.zshrc, after compinit. For fish, write the script to ~/.config/fish/completions/fingertip.fish.
    """
    from fingertip.design.parameters.declaration import suggest_name
    from fingertip.foundation.errors import DesignError, Issue

    if shell not in SHELLS:
        raise DesignError(Issue("SHELL", f"{shell!r} has no completion; {suggest_name(shell, SHELLS)}"))
    root = context.find_root()
    Console(False, quiet).write(format_script(shell, list(list_commands(root.command, root))))


def list_commands(group: Any, context: Any, prefix: str = "") -> Iterator[CommandWords]:
    """List the commands of a group with their words, those of groups within it too."""
    for name in group.list_commands(context):
        inner = group.get_command(context, name)
        if inner is None or inner.hidden:
            continue
        words = f"{prefix}{name}"
        flags: list[tuple[str, str]] = []
        options: list[tuple[str, str]] = []
        arguments: list[str] = []
        for parameter in inner.get_params(context):
            if parameter.param_type_name == "argument":
                arguments += _argument_names(words, parameter.name)
                continue
            listed = flags if parameter.is_flag else options
            meaning = _short(parameter.help or "")
            listed += [(option, meaning) for option in (*parameter.opts, *parameter.secondary_opts)]
        is_group = hasattr(inner, "list_commands")
        subcommands = tuple(inner.list_commands(context)) if is_group else ()
        yield CommandWords(words, _short(inner.help or ""), tuple(flags), tuple(options), (*subcommands, *arguments))
        if is_group:
            yield from list_commands(inner, context, f"{words} ")


def option_values() -> dict[str, tuple[str, ...]]:
    """Values of the options that take a word of a list."""
    from fingertip.catalogues.bundled import PARAMS, list_bundled_files
    from fingertip.catalogues.file_kinds import DESIGN
    from fingertip.catalogues.silicones import SILICONES
    from fingertip.design.parameters import PARAMETERS
    from fingertip.design.parameters.declaration import list_choices
    from fingertip.slip.detectors.registry import DETECTORS, list_names

    parameters: list[str] = []
    for path, field in PARAMETERS.items():
        parameters += [f"{path}={choice}" for choice in list_choices(field) or ("",)]
    designs = tuple(list_bundled_files(DESIGN))
    return {
        "--set": tuple(parameters),
        "--keep": tuple(PARAMETERS),
        "--design": designs,
        "--preset": tuple(name for name in designs if name.partition("_")[0] in ("adult", "youth", "child")),
        "--hand": tuple(sorted(path.stem for path in (PARAMS / "hands").glob("*.toml"))),
        "--formats": ("stl", "3mf", "step", "stl,3mf", "stl,3mf,step"),
        "--parts": ("bone", "skin", "mold_palmar", "mold_dorsal", "lid", "core"),
        "--material": (*SILICONES, "own"),
        "--detector": tuple(list_names()),
        "--grip": tuple(name for name in reversed(DETECTORS) if not DETECTORS[name].is_baseline),
        "--surface": ("smooth", "medium", "gross", "wood", "paper", "plastic"),
        "--time-scale": ("s", "ms", "us", "ns"),
    }


def format_script(shell: str, commands: list[CommandWords]) -> str:
    """Format the completion script of a shell."""
    return {"bash": _bash, "zsh": _zsh, "fish": _fish}[shell](commands)


def _argument_names(command_name: str, argument: str) -> list[str]:
    """Names that an argument may take, beside files."""
    from fingertip.catalogues.bundled import list_bundled_files
    from fingertip.catalogues.file_kinds import DESIGN, MANIPULATION, SCENE, SWEEP
    from fingertip.cli.design import KINDS

    if command_name == "schema":
        return [*KINDS]
    if command_name == "completion":
        return [*SHELLS]
    if command_name == "simulate":
        return [*list_bundled_files(DESIGN, SCENE, MANIPULATION)]
    if command_name == "sweep":
        return [*list_bundled_files(SWEEP)]
    return [*list_bundled_files(DESIGN)] if argument in ("design", "designs") else []


def _short(text: str) -> str:
    """First sentence of a description, without characters that a shell would read."""
    first = " ".join(text.split()).partition(". ")[0].removesuffix(".")
    return "".join(letter for letter in first if letter not in "'\"`$\\[]")


_BASH = """\
# Completion of fingertip for bash: eval "$(fingertip completion bash)"
_fingertip() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" line="${{COMP_LINE:0:COMP_POINT}}"
    local command="${{COMP_WORDS[1]}}" words="" flags="" options="" cut=""
    COMPREPLY=()
    # Bash cuts words at = and :, so the word at the cursor is taken from the line.
    word="${{line##*[[:space:]]}}"
    case "$word" in *=*) cut="${{word%"${{word##*=}}"}}" ;; esac
    local head="${{line%"$word"}}"
    head="${{head%"${{head##*[![:space:]]}}"}}"
    before="${{head##*[[:space:]]}}"
    if [[ "$before" == fingertip || "$before" == */fingertip ]]; then
        COMPREPLY=($(compgen -W "{commands} --help --version" -- "$word"))
        return
    fi
    case "$command" in
        {groups}) [[ -n "${{COMP_WORDS[2]}}" && "$before" != "$command" ]] && command+=" ${{COMP_WORDS[2]}}" ;;
    esac
    case "$command" in
{cases}
    esac
    case "$before" in
{values}
        -*) case " $flags " in *" $before "*) ;; *) COMPREPLY=($(compgen -f -- "$word")); return ;; esac ;;
    esac
    if [[ "$word" == -* ]]; then
        COMPREPLY=($(compgen -W "$flags $options" -- "$word"))
    elif [[ " {spaced_groups} " == *" $command "* ]]; then
        COMPREPLY=($(compgen -W "$words" -- "$word"))
    else
        COMPREPLY=($(compgen -W "$words" -- "$word") $(compgen -f -- "$word"))
    fi
}}
complete -o filenames -F _fingertip fingertip
"""


def _bash(commands: list[CommandWords]) -> str:
    top = [command.name for command in commands if " " not in command.name]
    groups = sorted({command.name.partition(" ")[0] for command in commands if " " in command.name})
    cases = []
    for entry in commands:
        flags, options = " ".join(name for name, _ in entry.flags), " ".join(name for name, _ in entry.options)
        words = " ".join(entry.arguments)
        cases.append(f'        "{entry.name}") flags="{flags}"; options="{options}"; words="{words}" ;;')
    values = []
    for option, choices in option_values().items():
        # What stands before the cursor's = is cut, because bash completes behind it only.
        reply = f'COMPREPLY=($(compgen -W "{" ".join(choices)}" -- "$word"))'
        after = '; COMPREPLY=("${COMPREPLY[@]#"$cut"}"); compopt -o nospace 2>/dev/null' if option == "--set" else ""
        values.append(f"        {option}) {reply}{after}; [[ ${{#COMPREPLY[@]}} -gt 0 ]] && return ;;")
    return _BASH.format(
        commands=" ".join(top),
        groups="|".join(groups),
        spaced_groups=" ".join(groups),
        cases="\n".join(cases),
        values="\n".join(values),
    )


def _zsh(commands: list[CommandWords]) -> str:
    values = option_values()
    top = [entry for entry in commands if " " not in entry.name]
    lines = [
        "#compdef fingertip",
        '# Completion of fingertip for zsh: eval "$(fingertip completion zsh)", after compinit',
        "_fingertip() {",
        "    local -a commands names",
        "    local command=${words[2]}",
        f"    commands=({' '.join(_zsh_item(entry.name, entry.help) for entry in top)})",
        "    if (( CURRENT == 2 )); then _describe 'command' commands; return; fi",
        "    case $command in",
        *(f'        {g}) (( CURRENT > 3 )) && command="$command ${{words[3]}}" ;;' for g in _groups(commands)),
        "    esac",
        "    case ${words[CURRENT-1]} in",
    ]
    for option, choices in values.items():
        suffix = "-S '' " if option == "--set" else ""
        quoted = " ".join(f"'{choice}'" for choice in choices)
        lines.append(f"        {option}) names=({quoted}); compadd {suffix}-a names; _files; return ;;")
    lines += ["    esac", "    case $command in"]
    for entry in commands:
        items = " ".join(_zsh_item(name, meaning) for name, meaning in (*entry.flags, *entry.options))
        lines += [
            f"        '{entry.name}')",
            f"            names=({items})",
            "            [[ ${words[CURRENT]} == -* ]] && { _describe 'option' names; return }",
            f"            names=({' '.join(entry.arguments)}); compadd -a names; _files ;;",
        ]
    return "\n".join([*lines, "    esac", "}", "compdef _fingertip fingertip"])


def _zsh_item(name: str, meaning: str) -> str:
    return f"'{name}:{meaning.replace(':', ' -')}'"


def _groups(commands: list[CommandWords]) -> list[str]:
    return sorted({entry.name.partition(" ")[0] for entry in commands if " " in entry.name})


def _fish(commands: list[CommandWords]) -> str:
    values = option_values()
    groups = _groups(commands)
    lines = [
        "# Completion of fingertip for fish; write it to ~/.config/fish/completions/fingertip.fish",
        "complete -c fingertip -e",
    ]
    for entry in commands:
        group, _, inner = entry.name.partition(" ")
        if inner:
            condition = f"__fish_seen_subcommand_from {group}; and __fish_seen_subcommand_from {inner}"
        else:
            lines.append(f"complete -c fingertip -n __fish_use_subcommand -f -a '{entry.name}' -d '{entry.help}'")
            condition = f"__fish_seen_subcommand_from {group}"
        if group in groups and not inner:
            seen = f"{condition}; and not __fish_seen_subcommand_from {' '.join(entry.arguments)}"
            lines.append(f"complete -c fingertip -n '{seen}' -f -a '{' '.join(entry.arguments)}'")
            continue
        if entry.arguments:
            lines.append(f"complete -c fingertip -n '{condition}' -a '{' '.join(entry.arguments)}'")
        for name, meaning in (*entry.flags, *entry.options):
            kind = f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
            takes = " -r" if (name, meaning) in entry.options else ""
            words = f" -a '{' '.join(values[name])}'" if takes and name in values else ""
            lines.append(f"complete -c fingertip -n '{condition}' {kind}{takes}{words} -d '{meaning}'")
    return "\n".join(lines)
