# Every target is a command of .ci/dev.sh, which also works without make: sh .ci/dev.sh run
# make run ARGS="--seconds 20 --seed 7" passes arguments.

.PHONY: setup run test test-long nightly planted check bench docs package fresh clean pins
.NOTPARALLEL:

setup run test test-long nightly planted check bench docs package fresh clean pins:
	@sh .ci/dev.sh $@ $(ARGS)
