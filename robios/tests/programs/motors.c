#include "check.h"

int main(void)
{
    int x, y, phi, left;

    CHECK(MOTORDrive(1, 50) == 0 && MOTORDrive(2, 50) == 0);
    OSWait(3000);
    VWGetPosition(&x, &y, &phi);
    NEAR(x, 560, 40); /* 0.2 m/s, but for the motors' lag */
    NEAR(y, 0, 5);
    left = ENCODERRead(1);
    NEAR(left, (int)(x / 0.1542), 20);
    CHECK(ENCODERReset(1) == 0 && ENCODERRead(1) == 0 && abs(ENCODERRead(2) - left) < 20);
    CHECK(MOTORDrive(1, 0) == 0 && MOTORDrive(2, 0) == 0);
    OSWait(2000);
    CHECK(MOTORDrive(5, 1) == 1 && MOTORDrive(3, 10) == 1 && ENCODERRead(0) == 0);
    CHECK(MOTORPID(1, 4, 1, 1) == 0 && MOTORPIDOff(1) == 0 && MOTORDriveRaw(1, 0) == 0);
    ENCODERReset(1);
    CHECK(MOTORSpeed(1, 5) == 0 && MOTORSpeed(2, -5) == 0); /* 500 ticks/s */
    OSWait(4000);
    NEAR(ENCODERRead(1), 1900, 100);
    VWGetPosition(&x, &y, &left);
    CHECK(left != phi);
    CHECK(VWSetSpeed(0, 0) == 0);
    return 0;
}
