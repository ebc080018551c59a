"""Completion in bash, zsh and fish: the words that options and arguments take, and `fingertip completion`.

At the tab key the shell starts the program with the line before the cursor, and typer finds what may stand there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, get_args

from fingertip.catalogues.silicones import SiliconeName

VARIABLE = "_FINGERTIP_COMPLETE"
"""Environment variable by which a shell asks for completions."""

# What the shells run. They get lines of a word, a tab and its meaning; where there is none, they complete files. No
# space follows the name of a parameter, which ends in =.


SCRIPTS = {
    "bash": r"""# Completion of fingertip for bash: eval "$(fingertip completion bash)"
_fingertip() {
    local IFS=$'\n' line="${COMP_LINE:0:COMP_POINT}" cut=""
    # Bash cuts words at = and completes behind it, so what stands before is taken off.
    local word="${line##*[[:space:]]}"
    case "$word" in *=*) cut="${word%"${word##*=}"}" ;; esac
    case "$word" in -*) cut="${cut#*=}" ;; esac
    COMPREPLY=($(env _FINGERTIP_COMPLETE=1 _TYPER_COMPLETE_ARGS="$line" "${1:-fingertip}" 2>/dev/null))
    COMPREPLY=("${COMPREPLY[@]%%$'\t'*}")
    [[ "${COMPREPLY[0]}" == *= ]] && compopt -o nospace 2>/dev/null
    COMPREPLY=("${COMPREPLY[@]#"$cut"}")
}
complete -o default -F _fingertip fingertip""",
    "zsh": r"""#compdef fingertip
# Completion of fingertip for zsh: eval "$(fingertip completion zsh)", after compinit
_fingertip() {
    local -a found
    found=(${(f)"$(env _FINGERTIP_COMPLETE=1 _TYPER_COMPLETE_ARGS="${words[1,CURRENT]}" ${words[1]} 2>/dev/null)"})
    if (( ! $#found )); then
        _files
    elif [[ ${found[1]%%$'\t'*} == *= ]]; then
        compadd -S '' -- ${found%%$'\t'*}
    else
        found=(${${found//:/\\:}/$'\t'/:})
        _describe word found
    fi
}
compdef _fingertip fingertip""",
    "fish": r"""# Completion of fingertip for fish; write it to ~/.config/fish/completions/fingertip.fish
function __fingertip_words
    set -l found (env _FINGERTIP_COMPLETE=1 _TYPER_COMPLETE_ARGS=(commandline -cp) fingertip 2>/dev/null)
    if set -q found[1]
        string join \n -- $found
    else
        __fish_complete_path (commandline -ct)
    end
end
complete -c fingertip -e
complete -c fingertip -f -a '(__fingertip_words)'""",
}


def answer_shell(root: Any) -> None:
    """Print what may stand at the cursor, for the command line of a program."""
    from typer._completion_classes import FishComplete

    shell = FishComplete(root, {}, "fingertip", VARIABLE)
    for item in shell.get_completions(*shell.get_completion_args()):
        print(item.value, *([first_sentence(item.help)] if item.help else []), sep="\t")


def first_sentence(text: str) -> str:
    first = text.split("\n\n")[0]
    end = first.find(". ")
    return first if end < 0 else first[: end + 1]


# Words that a parameter of a command takes. Functions import what they need when a shell asks.


def _words(*words: str) -> Callable[[], Iterable[str]]:
    def complete() -> Iterable[str]:
        return words

    return complete


def _files(*kinds: str) -> Callable[[str], Iterable[str]]:
    """Bundled files of some kinds, and files of the user, of any kind."""

    def complete(incomplete: str) -> Iterable[str]:
        import glob

        from fingertip.catalogues import file_kinds
        from fingertip.catalogues.bundled import list_bundled_files

        bundled = list_bundled_files(*(getattr(file_kinds, kind) for kind in kinds))
        own = glob.glob(f"{glob.escape(incomplete)}*.toml")
        return [*bundled, *sorted(name for name in own if name.isprintable())]  # others would control the terminal

    return complete


def _hands() -> Iterable[str]:
    from fingertip.catalogues.bundled import PARAMS

    return sorted(path.stem for path in (PARAMS / "hands").glob("*.toml"))


def _parameters() -> Iterable[str]:
    from fingertip.design.parameters import PARAMETERS

    return PARAMETERS


def _settings() -> Iterable[str]:
    """Parameters with =, and with each choice of those that have choices."""
    from fingertip.design.parameters import PARAMETERS
    from fingertip.design.parameters.declaration import list_choices

    return [f"{path}={choice}" for path, field in PARAMETERS.items() for choice in list_choices(field) or ("",)]


COMPLETIONS = {
    "design": _files("DESIGN"),
    "designs": _files("DESIGN"),
    "simulate file": _files("DESIGN", "SCENE", "MANIPULATION"),
    "sweep file": _files("SWEEP"),
    "changes": _settings,
    "keep": _parameters,
    "hand": _hands,
    "preset": _words(*(f"{age}_{digit}" for age in ("adult", "child", "youth") for digit in ("finger", "thumb"))),
    "formats": _words("stl", "3mf", "step", "stl,3mf", "stl,3mf,step"),
    "parts": _words("bone", "skin", "mold_palmar", "mold_dorsal", "lid", "core", "sensor_insert", "insert_jig"),
    "material": _words(*get_args(SiliconeName), "own"),
    "detector": _words("digital", "analog", "fft", "fast", "incipient"),
    "grip": _words("fast", "incipient", "digital", "analog"),
    "surface": _files("SURFACE"),
    "time_scale": _words("s", "ms", "us", "ns"),
    "kind": _words("design", "scene", "manipulation", "surface", "sweep"),
    "shell": _words(*SCRIPTS),
}
"""Parameter of all commands, or of one, -> words that it takes."""
