# Completion of fingertip for fish; write it to ~/.config/fish/completions/fingertip.fish
function __fingertip_words
    set -l found (env _FINGERTIP_COMPLETE=1 _TYPER_COMPLETE_ARGS=(commandline -cp) fingertip 2>/dev/null)
    if set -q found[1]
        string join \n -- $found
    else
        __fish_complete_path (commandline -ct)
    end
end
complete -c fingertip -e
complete -c fingertip -f -a '(__fingertip_words)'
