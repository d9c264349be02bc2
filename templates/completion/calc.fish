# Completion of calc for fish: plugins, inputs, results and run folders. Written by `calc completion fish`.
function __calc_complete
    set -l command (commandline -po)[1]
    set -l found (env _CALC_COMPLETE=complete_fish _TYPER_COMPLETE_FISH_ACTION=get-args \
        _TYPER_COMPLETE_ARGS=(commandline -cp) $command 2>/dev/null)
    if test -n "$found"
        printf '%s\n' $found
    else
        __fish_complete_path (commandline -ct)
    end
end
complete --command calc --no-files --arguments '(__calc_complete)'
complete --command truing --no-files --arguments '(__calc_complete)'
