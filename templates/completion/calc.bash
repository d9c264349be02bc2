# Completion of calc for bash: plugins, inputs, results and run folders. Written by `calc completion bash`.
_calc_completion() {
    local line=${COMP_LINE:0:COMP_POINT} word=${COMP_WORDS[COMP_CWORD]} before found
    # bash breaks words at = and :, and replaces what stands behind the break only
    [[ $word == [=:] ]] && word=
    before=${line##*[[:space:]]}
    before=${before%"$word"}
    COMPREPLY=()
    while IFS=$'\t' read -r found _; do
        [[ -n $found ]] && COMPREPLY+=("${found#"$before"}")
    done < <(env _CALC_COMPLETE=complete_fish _TYPER_COMPLETE_FISH_ACTION=get-args \
        _TYPER_COMPLETE_ARGS="$line" "$1" 2>/dev/null)
    # behind a name that goes on there is no space
    [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./] ]] && compopt -o nospace 2>/dev/null
    return 0
}
complete -o default -F _calc_completion calc truing
