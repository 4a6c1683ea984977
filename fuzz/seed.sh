#!/bin/sh
# Fills corpus/TARGET with the small files of tests/data.
set -eu
cd "$(dirname "$0")"
data=../tests/data
for target in wld maz robi esobj sim ros_map movingai track maze recording; do mkdir -p "corpus/$target"; done
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
# The beginnings of recordings: `-max_len` leaves no more of them.
for log in "$data"/logs/*.mcap; do head -c 4096 "$log" > "corpus/recording/$(basename "$log")"; done
