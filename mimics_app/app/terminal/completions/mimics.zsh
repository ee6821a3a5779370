_mimics() {
    local -a found
    found=(${(f)"$(print -rl -- "${(@)words[2,CURRENT]}" | mimics completion words 2>/dev/null)"})
    if (( ${#found} )); then compadd -- $found; else _files; fi
}
compdef _mimics mimics
