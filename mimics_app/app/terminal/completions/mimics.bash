_mimics() {
    local IFS=$'\n'
    COMPREPLY=($(printf '%s\n' "${COMP_WORDS[@]:1:COMP_CWORD}" | mimics completion words 2>/dev/null))
}
complete -o default -F _mimics mimics
