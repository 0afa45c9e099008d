#include "pilotage/scene/synthetic_scene.h"

#include <gtest/gtest.h>
