#!/usr/bin/env bash
# Completes a command line as bash does and prints what it would offer, one a line.
#
#   complete.bash WORD...      the words after "pilotage", cut as bash cuts them ("--flag" "=" "value"); the last is typed
set -u
source <(pilotage completion bash)
[[ $(complete -p pilotage) == "complete -F _pilotage pilotage" ]]
COMP_WORDS=(pilotage "$@")
COMP_CWORD=$#
_pilotage
((${#COMPREPLY[@]} == 0)) || printf '%s\n' "${COMPREPLY[@]}"
