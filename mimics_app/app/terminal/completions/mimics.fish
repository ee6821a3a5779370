function __mimics_words
    begin; commandline -opc | tail -n +2; commandline -ct; end | mimics completion words 2>/dev/null
end
complete -c mimics -a '(__mimics_words)'
