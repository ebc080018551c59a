#compdef fingertip
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
compdef _fingertip fingertip
