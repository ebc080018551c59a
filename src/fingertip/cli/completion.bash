# Completion of fingertip for bash: eval "$(fingertip completion bash)"
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
complete -o default -F _fingertip fingertip
