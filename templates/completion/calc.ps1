# Completion of calc for PowerShell: plugins, inputs, results and run folders. Written by `calc completion powershell`.
Register-ArgumentCompleter -Native -CommandName calc, truing -ScriptBlock {
    param($wordToComplete, $commandAst, $cursorPosition)
    $Env:_CALC_COMPLETE = "complete_powershell"
    $Env:_TYPER_COMPLETE_ARGS = $commandAst.ToString()
    $Env:_TYPER_COMPLETE_WORD_TO_COMPLETE = $wordToComplete
    try {
        & $commandAst.CommandElements[0].Value 2>$null | ForEach-Object {
            $name, $help = $_ -split ":::", 2
            if ($name) {
                $shown = if ($help.Trim()) { $help } else { $name }
                [System.Management.Automation.CompletionResult]::new($name, $name, "ParameterValue", $shown)
            }
        }
    }
    finally {
        Remove-Item Env:_CALC_COMPLETE, Env:_TYPER_COMPLETE_ARGS, Env:_TYPER_COMPLETE_WORD_TO_COMPLETE
    }
}
