#!/bin/sh
# Fills corpus/TARGET with the small files of tests/data.
set -eu
cd "$(dirname "$0")"
data=../tests/data
for target in wld maz robi esobj sim ros_map movingai track maze recording image worker checkpoint weights wire; do mkdir -p "corpus/$target"; done
for target in wld maz robi; do
    for file in "$data"/formats/*."$target" "$data/broken/$target"/*."$target"; do
        [ "$(wc -c < "$file")" -gt 4096 ] || cp "$file" "corpus/$target/"
    done
done
cp "$data"/formats/*.esObj "$data"/broken/esobj/*.esObj corpus/esobj/
cp "$data"/formats/*.sim "$data"/broken/sim/*.sim corpus/sim/
printf 'world a.wld\nrobot a.robi\na 1 2 3\n\fdrive OMNI_DRIVE\n' > corpus/sim/own-files
cp "$data"/broken/ros_map/*.yaml corpus/ros_map/
for yaml in room.yaml scale.yml; do
    { cat "$data/formats/$yaml"; printf '\f'; cat "$data/formats/room.pgm"; } > "corpus/ros_map/$yaml"
done
cp "$data"/grids/*.map "$data"/grids/*.scen "$data"/broken/movingai_map/*.map "$data"/broken/movingai_scen/*.scen \
    corpus/movingai/
cp "$data"/cones/*.csv "$data"/cones/*.yaml corpus/track/
cp "$data"/mazes/* "$data"/broken/maz/*.maz corpus/maze/
# A whole recording with three edits, and the beginnings of others: `-max_len` leaves no more of them.
printf '~\0\001\003\007\0\002\0\007\0\003\002\0' > corpus/recording/edits
for log in "$data"/logs/*.mcap; do head -c 4096 "$log" > "corpus/recording/$(basename "$log")"; done
cp "$data"/formats/*.png "$data"/formats/*.pgm corpus/image/
printf 'ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n0 1\n2 3\n' > corpus/image/ground.asc
printf '7 3 0 1e80c8288090\n7 3 1 00ff\n' > corpus/worker/two
printf '{"version":1,"settings":"fuzz","state":{"genomes":[[1,2],[3,4]],"seed":1,"generation":0,"fitness":[],"best":null,"history":[]}}' > corpus/checkpoint/two
# A header of 60 bytes, and one number.
printf '\074\0\0\0\0\0\0\0{"signs":{"dtype":"F32","shape":[1,1],"data_offsets":[0,4]}}\0\0\0\0' > corpus/weights/one
cp ../cli/nets/steering.safetensors corpus/weights/network
# The question for the pose, and an answer: done.
printf '\0\0\0\0\0\0\0\0\0\004' > corpus/wire/question
printf '\0\0\0\0\0\0\0\0\001\002\0\0\0\0\0\0\0\0\0' > corpus/wire/answer
