#compdef calc truing
# Completion of calc for zsh: plugins, inputs, results and run folders. Written by `calc completion zsh`.
_calc() {
    local -a whole open
    local value help
    while IFS=$'\t' read -r value help; do
        case $value in
            '') ;;
            *[=./]) open+=("${value//:/\\:}:${help:-$value}") ;;
            *) whole+=("${value//:/\\:}:${help:-$value}") ;;
        esac
    done < <(env _CALC_COMPLETE=complete_fish _TYPER_COMPLETE_FISH_ACTION=get-args \
        _TYPER_COMPLETE_ARGS="${(j: :)words[1,CURRENT]}" "${words[1]}" 2>/dev/null)
    if (( ! $#whole && ! $#open )); then
        _files
        return
    fi
    # behind a name that goes on there is no space
    (( $#whole )) && _describe -t names name whole
    (( $#open )) && _describe -t names name open -S ''
}
(( $+functions[compdef] )) || { autoload -Uz compinit && compinit }
if [[ $funcstack[1] == _calc ]]; then
    _calc "$@"
else
    compdef _calc calc truing
fi
