# Every word here is a word of .ci/dev.sh, which also works where make is not installed: sh .ci/dev.sh run
# make run ARGS="--seconds 20 --seed 7" hands arguments on.

.PHONY: setup run test test-long nightly check bench clean pins
.NOTPARALLEL:

setup run test test-long nightly check bench clean pins:
	@sh .ci/dev.sh $@ $(ARGS)
